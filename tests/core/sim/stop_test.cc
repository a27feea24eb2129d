// A stop request ends a run within the current step, frame or set-up, which is discarded.
#include <gtest/gtest.h>

#include <memory>

#include "tests/support/brick_bodies.h"
#include "tests/support/eulerian_scenes.h"
#include "tests/support/stage_watch.h"
#include "tests/support/tet_scenes.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;

constexpr int kManyFrames = 100'000;

Scene Endless(Scene scene, double frame_interval) {
  scene.output.frame_interval = frame_interval;
  scene.duration = kManyFrames * frame_interval;
  return scene;
}

Scene StoppedBeam(Stepping stepping) {
  Body body = BoxBody(Vec3(0.06, 0.02, 0.02), {6, 2, 2}, NeoHookean(std::array{1e4, 0.3}));
  body.constraints.push_back(Fix(kX0));
  body.loads.push_back({kX1, Traction{Vec3(0, 0, -50)}, Curve{{0, 1, 2}, {0, 1, 0.5}}, {}});
  body.damping.viscosity = stepping == Stepping::kMixed ? 2 : 0;
  Scene scene = OneBody(body);
  scene.tet.stepping = stepping;
  scene.tet.linear_solver = LinearSolver::kIterative;
  return Endless(std::move(scene), 0.005);
}

Scene VoxelBar(VoxelStepping stepping) {
  Body body = VoxelBox(Vec3(0.04, 0.01, 0.02), {16, 4, 8}, CorotatedLinear(std::array{2e5, 0.25}));
  body.constraints = {{0, {true, true, true}, {}}};
  body.loads.push_back({1, Traction{Vec3(0, 0, 100)}, Curve{{0, 1000}, {0, 1000}}, {}});
  Scene scene = VoxelScene(std::move(body));
  scene.voxel.stepping = stepping;
  return Endless(std::move(scene), 0.01);
}

Scene Block() {
  Body body = EulerianCube();
  body.damping.mass_proportional = 20;
  body.constraints = {{0, {true, true, true}, {}}};
  Scene scene = EulerianScene({std::move(body)});
  scene.gravity.acceleration = Vec3(1, 0, 0);
  return Endless(std::move(scene), 0.005);
}

// Ends a run between two steps after the given number of frames.
class SinkOfFrames : public CollectingSink {
 public:
  explicit SinkOfFrames(std::size_t count) : count_(count) {}
  bool PutFrame(Frame frame, std::string checkpoint) override {
    CollectingSink::PutFrame(std::move(frame), std::move(checkpoint));
    if (frames.size() >= count_) enough_.request_stop();
    return true;
  }
  std::stop_token token() const { return enough_.get_token(); }

 private:
  std::size_t count_;
  std::stop_source enough_;
};

struct StopCase {
  const char* name;
  Scene (*scene)();
  const char* stage;   // during which the request is made
  std::int64_t calls;  // of the previous stage
};

class StopTest : public ::testing::TestWithParam<StopCase> {};

TEST_P(StopTest, EndsWithinAStageAndCanBeRunOn) {
  const auto scene = std::make_shared<const Scene>(GetParam().scene());
  Profile profile;
  Simulation simulation(scene, 2, &profile);
  StopAtStage stop(profile, GetParam().stage, GetParam().calls);
  CollectingSink first;
  ASSERT_EQ(simulation.Run(first, stop.token(), std::chrono::hours(1)).kind, Outcome::Kind::kCancelled);
  EXPECT_LE(CallsOf(profile, GetParam().stage), stop.CallsAtStop()) << "the stage was not entered again";

  // Continued, it produces the frames of an undisturbed run.
  SinkOfFrames rest(2);
  ASSERT_EQ(simulation.Run(rest, rest.token(), std::chrono::hours(1)).kind, Outcome::Kind::kCancelled);
  SinkOfFrames undisturbed(first.frames.size() + 2);
  Simulation(scene, 1).Run(undisturbed, undisturbed.token(), std::chrono::hours(1));
  ASSERT_EQ(undisturbed.frames.size(), first.frames.size() + 2);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(rest.frames[k].digest, undisturbed.frames[first.frames.size() + k].digest) << k;
  }
}

const StopCase kCases[] = {
    {"explicit", [] { return StoppedBeam(Stepping::kExplicit); }, "step/elastic force", 20},
    {"mixed", [] { return StoppedBeam(Stepping::kMixed); }, "step/damping", 20},
    {"stable_step", [] { return StoppedBeam(Stepping::kExplicit); }, "step/stable step", 2},
    {"newton", [] { return StoppedBeam(Stepping::kBackwardEuler); }, "step/Newton/iterative solve", 5},
    {"assembly", [] { return StoppedBeam(Stepping::kQuasiStatic); }, "step/Newton/assembly", 3},
    {"static_voxels", [] { return VoxelBar(VoxelStepping::kStatic); }, "step/static solve", 3},
    {"dynamic_voxels", [] { return VoxelBar(VoxelStepping::kDynamic); }, "step/dynamic solve", 3},
    {"eulerian", Block, "step/constraints", 5},
    {"frame", Block, "frame/series", 2}};

INSTANTIATE_TEST_SUITE_P(Methods, StopTest, ::testing::ValuesIn(kCases),
                         [](const auto& tested) { return std::string(tested.param.name); });

TEST(SetUpTest, EndsOnRequest) {
  std::stop_source stop;
  stop.request_stop();
  for (const Scene& scene : {StoppedBeam(Stepping::kExplicit), StoppedBeam(Stepping::kQuasiStatic),
                             VoxelBar(VoxelStepping::kDynamic), VoxelBar(VoxelStepping::kStatic), Block()}) {
    Profile profile;
    EXPECT_THROW(Simulation(std::make_shared<const Scene>(scene), 1, &profile, stop.get_token()), Stopped);
    EXPECT_EQ(CallsOf(profile, "initial state"), 0) << "the model was made";
  }
}

}  // namespace
}  // namespace fascicle
