#include "core/sim/simulation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <thread>

#include "tests/support/tet_scenes.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;
using ::testing::HasSubstr;

Scene Beam() {
  Body body = BoxBody(Vec3(0.06, 0.02, 0.02), {6, 2, 2}, NeoHookean(std::array{1e4, 0.3}));
  body.constraints.push_back(Fix(kX0));
  body.loads.push_back({kX1, Traction{Vec3(0, 0, -50)}, Curve{{0, 0.05}, {0, 1}, Curve::Interpolation::kSmooth}, {}});
  body.damping.mass_proportional = 40;
  Scene scene = OneBody(body);
  scene.output.fields = {OutputField::kVelocity, OutputField::kVolumeRatio};
  scene.output.probes = {{"tip", 0, 6}};
  scene.output.frame_interval = 0.02;
  scene.duration = 0.09;
  return scene;
}

TEST(SimulationTest, FramesLandOnTheirTimes) {
  const RunResult run = RunScene(Beam());
  EXPECT_EQ(run.outcome.kind, Outcome::Kind::kSucceeded);
  ASSERT_EQ(run.frames.size(), 6u);
  const double times[] = {0, 0.02, 0.04, 0.06, 0.08, 0.09};
  for (std::size_t k = 0; k < run.frames.size(); ++k) {
    EXPECT_EQ(run.frames[k].index, static_cast<std::int64_t>(k));
    EXPECT_EQ(run.frames[k].time, k == 5 ? 0.09 : static_cast<double>(k) * 0.02);
    EXPECT_NEAR(run.frames[k].time, times[k], 1e-15);
    EXPECT_EQ(run.frames[k].digest, DigestOf(run.frames[k]));
    EXPECT_EQ(run.frames[k].series.size(), run.series.size());
  }
  EXPECT_EQ(run.progress.fraction, 1);
  EXPECT_EQ(run.progress.step, run.frames.back().step);
}

// An interval that divides the duration except for round-off does not add a frame of almost zero length.
TEST(SimulationTest, NoSliverFrame) {
  Scene scene = Beam();
  scene.duration = 0.03;
  scene.output.frame_interval = 0.01;  // 0.03 / 0.01 = 3 - 4e-16 or so
  EXPECT_EQ(RunScene(scene).frames.size(), 4u);
  scene.duration = 0.3 * 0.1;
  EXPECT_EQ(RunScene(scene).frames.size(), 4u);
}

TEST(SimulationTest, SeriesAreNamedAndInUnits) {
  const RunResult run = RunScene(Beam());
  std::vector<std::string> names;
  for (const SeriesInfo& info : run.series) {
    names.push_back(info.name);
    EXPECT_FALSE(info.unit.empty());
    EXPECT_FALSE(info.description.empty());
  }
  EXPECT_THAT(names,
              ::testing::IsSupersetOf({"energy/elastic", "energy/kinetic", "energy/external_work", "energy/dissipated",
                                       "solver/step", "solver/iterations", "box/volume_ratio", "box/min_volume_ratio",
                                       "box/activation", "box/reaction/x0/x", "box/reaction/x0/y", "box/reaction/x0/z",
                                       "probe/tip/x", "probe/tip/y", "probe/tip/z"}));
  const Frame& last = run.frames.back();
  EXPECT_EQ(run.Last("probe/tip/z"), last.bodies[0].positions[6][2] - 0.0);
  // The energy balance holds to the order of the scheme.
  EXPECT_NEAR(run.Last("energy/elastic") + run.Last("energy/kinetic") + run.Last("energy/dissipated"),
              run.Last("energy/external_work"), 1e-3 * run.Last("energy/external_work"));
  EXPECT_EQ(run.At(0, "box/volume_ratio"), 1);
}

TEST(SimulationTest, FieldsAreAsAskedFor) {
  const RunResult run = RunScene(Beam());
  const BodyFrame& body = run.frames.back().bodies[0];
  ASSERT_EQ(body.fields.size(), 2u);
  EXPECT_EQ(body.fields[0].name, "velocity");
  EXPECT_EQ(body.fields[0].location, FieldLocation::kNode);
  EXPECT_EQ(body.fields[0].values.size(), 3 * body.positions.size());
  EXPECT_EQ(body.fields[1].name, "volume_ratio");
  EXPECT_EQ(body.fields[1].location, FieldLocation::kTetrahedron);
  EXPECT_EQ(body.fields[1].values.size(), 6u * 24);
}

TEST(SimulationTest, SettlesAfterTheCurvesHaveComeToRest) {
  Scene scene = Beam();
  scene.duration = 10;
  scene.output.settle_speed = 1e-3;
  const RunResult run = RunScene(scene);
  EXPECT_EQ(run.outcome.kind, Outcome::Kind::kSucceeded);
  EXPECT_LT(run.frames.back().time, 5);
  EXPECT_GE(run.frames.back().time, 0.05);
  EXPECT_EQ(run.progress.fraction < 1, true);
  double fastest = 0;
  const std::vector<double>& v = run.frames.back().bodies[0].fields[0].values;
  for (std::size_t i = 0; i < v.size(); i += 3) fastest = std::max(fastest, Vec3(v[i], v[i + 1], v[i + 2]).norm());
  EXPECT_LE(fastest, 1e-3);
  // Restored from the last checkpoint, the run is complete.
  Simulation simulation(std::make_shared<Scene>(scene), 1);
  ASSERT_TRUE(simulation.Restore(run.checkpoints.back()));
  CollectingSink sink;
  EXPECT_EQ(simulation.Run(sink, {}).kind, Outcome::Kind::kSucceeded);
  EXPECT_TRUE(sink.frames.empty());
}

// The stages of a profile, and the seconds of those directly in a step.
std::pair<std::map<std::string, ProfileStage>, double> StagesOf(const Profile& profile) {
  std::map<std::string, ProfileStage> stages;
  double parts = 0;
  for (const ProfileStage& stage : profile.Stages()) {
    stages[stage.name] = stage;
    const bool direct = std::count(stage.name.begin(), stage.name.end(), '/') == 1;
    if (direct && stage.name.starts_with("step/")) parts += stage.seconds;
  }
  return {stages, parts};
}

TEST(SimulationTest, AProfileCountsTheStagesAndChangesNoBit) {
  for (const Stepping stepping : {Stepping::kExplicit, Stepping::kMixed, Stepping::kBackwardEuler}) {
    Scene scene = Beam();
    scene.tet.stepping = stepping;
    const RunResult run = RunScene(scene);
    Profile profile;
    CollectingSink sink;
    Simulation(std::make_shared<Scene>(scene), 1, &profile).Run(sink, {}, std::chrono::milliseconds(0));
    ASSERT_EQ(sink.frames.size(), run.frames.size());
    for (std::size_t i = 0; i < run.frames.size(); ++i) EXPECT_EQ(sink.frames[i].digest, run.frames[i].digest);
    EXPECT_EQ(sink.checkpoints, run.checkpoints);

    const auto [stages, parts] = StagesOf(profile);
    EXPECT_EQ(stages.at("step").calls, run.progress.step);
    EXPECT_EQ(stages.at("step/controls").calls, run.progress.step);
    EXPECT_EQ(stages.at("frame").calls, 6);
    EXPECT_EQ(stages.at("checkpoint").calls, 6);
    EXPECT_EQ(stages.at(stepping == Stepping::kBackwardEuler ? "step/Newton" : "step/elastic force").calls,
              run.progress.step);
    EXPECT_LE(parts, stages.at("step").seconds);
    EXPECT_GT(profile.cpu_seconds(), 0);
  }
}

// The stages leave little of a step out. A thread that loses the processor between two stages makes that more, in some
// of the runs.
TEST(SimulationTest, TheStagesOfAProfileMakeUpTheStep) {
  double largest = 0;
  for (int run = 0; run < 10; ++run) {
    Profile profile;
    CollectingSink sink;
    Simulation(std::make_shared<Scene>(Beam()), 1, &profile).Run(sink, {}, std::chrono::milliseconds(0));
    const auto [stages, parts] = StagesOf(profile);
    largest = std::max(largest, parts / stages.at("step").seconds);
  }
  EXPECT_GT(largest, 0.8);
}

TEST(SimulationTest, CancelledBetweenTwoSteps) {
  class StoppingSink : public CollectingSink {
   public:
    explicit StoppingSink(std::stop_source& source) : source_(source) {}
    void PutProgress(const Progress& now) override {
      CollectingSink::PutProgress(now);
      if (now.step == 10) source_.request_stop();
    }

   private:
    std::stop_source& source_;
  };
  std::stop_source source;
  StoppingSink sink(source);
  Simulation simulation(std::make_shared<Scene>(Beam()), 1);
  EXPECT_EQ(simulation.Run(sink, source.get_token()).kind, Outcome::Kind::kCancelled);
  EXPECT_EQ(sink.progress.step, 10);
  EXPECT_EQ(sink.frames.size(), 1u);
}

TEST(SimulationTest, AStoreThatFailsEndsTheRun) {
  class FullSink : public CollectingSink {
   public:
    bool PutFrame(Frame frame, std::string checkpoint) override {
      return frames.size() < 2 && CollectingSink::PutFrame(std::move(frame), std::move(checkpoint));
    }
  };
  FullSink sink;
  Simulation simulation(std::make_shared<Scene>(Beam()), 1);
  const Outcome outcome = simulation.Run(sink, {});
  EXPECT_EQ(outcome.kind, Outcome::Kind::kFailed);
  EXPECT_EQ(outcome.failure.reason, "STORAGE");
}

TEST(CheckpointTest, RestoresOnlyItsOwnScene) {
  const Scene scene = Beam();
  const std::string checkpoint = RunScene(scene).checkpoints[2];
  const auto restores = [&](const Scene& other, const std::string& bytes) {
    Simulation simulation(std::make_shared<Scene>(other), 1);
    const bool restored = simulation.Restore(bytes);
    EXPECT_EQ(simulation.next_frame(), restored ? 3 : 0);
    return restored;
  };
  EXPECT_TRUE(restores(scene, checkpoint));
  Scene other = scene;
  other.bodies[0].material = NeoHookean(std::array{1.001e4, 0.3});
  EXPECT_FALSE(restores(other, checkpoint));
  other = scene;
  other.bodies[0].tet().mesh.nodes[0][0] += 1e-9;
  EXPECT_FALSE(restores(other, checkpoint));
  other = scene;
  other.tet.safety = 0.8;
  EXPECT_FALSE(restores(other, checkpoint));
  other = scene;
  other.bodies[0].loads[0].scale.times[1] = 0.06;
  EXPECT_FALSE(restores(other, checkpoint));
}

// Truncated or damaged anywhere, a checkpoint is refused without a crash, and the run starts from rest.
TEST(CheckpointTest, DamagedBytesAreRefused) {
  const Scene scene = Beam();
  const RunResult run = RunScene(scene);
  std::string bytes = run.checkpoints[1];
  Simulation simulation(std::make_shared<Scene>(scene), 1);
  for (const std::size_t size : {std::size_t{0}, std::size_t{10}, bytes.size() / 2, bytes.size() - 1}) {
    EXPECT_FALSE(simulation.Restore(bytes.substr(0, size)));
  }
  bytes[bytes.size() / 3] ^= 1;
  EXPECT_FALSE(simulation.Restore(bytes));
  CollectingSink sink;
  simulation.Run(sink, {});
  EXPECT_EQ(sink.frames.back().digest, run.frames.back().digest);
}

TEST(CheckpointTest, GoesWithTheFirstFrameAfterTheInterval) {
  Simulation simulation(std::make_shared<Scene>(Beam()), 1);
  CollectingSink sink;
  simulation.Run(sink, {}, std::chrono::hours(1));
  ASSERT_EQ(sink.checkpoints.size(), 6u);
  for (std::size_t k = 0; k < 5; ++k) EXPECT_TRUE(sink.checkpoints[k].empty());
  EXPECT_FALSE(sink.checkpoints[5].empty());
}

// A body compressed beyond zero volume: the run must fail, report where, and keep all earlier frames.
TEST(FailureTest, CrushedBodyFailsWithElementsAndKeepsItsFrames) {
  Scene scene = Beam();
  scene.bodies[0].material = StVenantKirchhoff(std::array{1e4, 0.3});
  scene.bodies[0].loads.clear();
  Constraint push = Fix(kX1);
  push.motion.translation[0] = Curve{{0, 0.1}, {0, -0.09}};  // the body is 0.06 m long
  scene.bodies[0].constraints.push_back(push);
  scene.duration = 0.1;
  scene.output.frame_interval = 0.002;
  const RunResult run = RunScene(scene);
  ASSERT_EQ(run.outcome.kind, Outcome::Kind::kFailed);
  const Failure& failure = run.outcome.failure;
  EXPECT_EQ(failure.reason, "INVERTED_ELEMENT");
  EXPECT_EQ(failure.object_kind, ObjectKind::kBody);
  EXPECT_EQ(failure.object, "box");
  ASSERT_FALSE(failure.elements.empty());
  EXPECT_LE(failure.elements.size(), 16u);
  for (const std::int64_t e : failure.elements) EXPECT_LT(e, 6 * 24);
  EXPECT_FALSE(failure.message.empty());
  EXPECT_FALSE(failure.advice.empty());
  EXPECT_GT(failure.step, 0);
  // Every frame before the failure exists and is valid.
  ASSERT_GE(run.frames.size(), 2u);
  EXPECT_LE(run.frames.back().time, failure.time);
  EXPECT_GT(run.frames.back().time, failure.time - 0.0021);
  for (std::size_t k = 0; k < run.frames.size(); ++k) EXPECT_GT(run.At(k, "box/min_volume_ratio"), 0);
}

// The same with a law of unlimited resistance: the step becomes too small, or an element inverts at last.
TEST(FailureTest, CrushedStiffBodyFails) {
  Scene scene = Beam();
  scene.bodies[0].loads.clear();
  Constraint push = Fix(kX1);
  push.motion.translation[0] = Curve{{0, 0.02}, {0, -0.09}};
  scene.bodies[0].constraints.push_back(push);
  const RunResult run = RunScene(scene);
  ASSERT_EQ(run.outcome.kind, Outcome::Kind::kFailed);
  EXPECT_THAT(run.outcome.failure.reason, ::testing::AnyOf("STEP_TOO_SMALL", "INVERTED_ELEMENT", "NOT_FINITE"));
  EXPECT_FALSE(run.outcome.failure.elements.empty());
  EXPECT_LE(run.outcome.failure.time, 0.02);
}

// Several simulations exist in one process, so there are no globals.
TEST(SimulationTest, TwoAtOnce) {
  const Scene scene = Beam();
  const Digest reference = RunScene(scene).frames.back().digest;
  Digest digests[2];
  std::thread other([&] { digests[0] = RunScene(scene, 2).frames.back().digest; });
  digests[1] = RunScene(scene, 2).frames.back().digest;
  other.join();
  EXPECT_EQ(digests[0], reference);
  EXPECT_EQ(digests[1], reference);
}

}  // namespace
}  // namespace fascicle
