// The same bits for any number of threads, and after any interruption.
#include <gtest/gtest.h>

#include <random>

#include "tests/support/tet_scenes.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;

// Sanitized programs are at least ten times slower, so they run a quarter of the time.
#ifdef FASCICLE_SANITIZED
constexpr bool kSlow = true;
#else
constexpr bool kSlow = false;
#endif

// A contracting muscle beside a bar that is bent, twisted and loaded, with every feature of a step; large enough that
// every thread has work (`across` hexahedra).
Scene BusyScene(Stepping stepping, ElementOrder element, int across) {
  Body muscle = MakeBody("muscle",
                         MakeFusiform({.length = 0.1,
                                       .belly_radius = 0.012,
                                       .end_radius = 0.006,
                                       .divisions_across = across,
                                       .divisions_along = 16}),
                         Muscle(std::array{5e2, 5e2, 2e5, 3e4, 1.4, 0.05, 6.6, 1.4}));
  muscle.tet().fibres = ConstantFibres(muscle.tet().mesh, Vec3::UnitZ());
  muscle.constraints = {Fix(kZ0), Fix(kZ1)};
  muscle.activation = {{0, 0.005}, {0, 1}, Curve::Interpolation::kSmooth};
  muscle.damping = {.mass_proportional = 10, .viscosity = 2};
  Body bar = BoxBody(Vec3(0.06, 0.02, 0.02), {12, across, across}, CorotatedLinear(std::array{1e4, 0.3}));
  Constraint turn = Fix(kX1);
  turn.motion.rotation = Rotation{Vec3(0, 0.01, 0.01), Vec3::UnitX(), Curve{{0, 0.01}, {0, 0.2}}};
  bar.constraints = {Fix(kX0), turn};
  bar.loads.push_back({kY1, Traction{Vec3(0, 100, 0)}, Curve{{0, 0.003}, {0, 1}}});
  bar.damping = {.mass_proportional = 5, .stiffness_proportional = 1e-4};
  Scene scene;
  scene.bodies = {muscle, bar};
  scene.gravity.acceleration = Vec3(0, 0, -9.81);
  scene.tet.stepping = stepping;
  scene.tet.element = element;
  scene.duration = 0.006;
  scene.output.frame_interval = 0.0008;
  scene.output.fields = {OutputField::kVelocity, OutputField::kCauchyStress, OutputField::kFibreStretch};
  scene.output.probes = {{"bar", 1, 100}};
  return scene;
}

std::vector<Digest> DigestsOf(const std::vector<Frame>& frames) {
  std::vector<Digest> digests;
  for (const Frame& frame : frames) digests.push_back(frame.digest);
  return digests;
}

class DeterminismTest : public ::testing::TestWithParam<std::tuple<Stepping, ElementOrder>> {
 protected:
  // Implicit and quadratic steps take longer: they get fewer elements, and explicit quadratic ones a shorter time.
  static Scene SceneOf() {
    const auto& [stepping, element] = GetParam();
    const bool is_explicit = stepping == Stepping::kExplicit || stepping == Stepping::kMixed;
    Scene scene = BusyScene(stepping, element, is_explicit && element == ElementOrder::kLinear ? 8 : 2);
    if (kSlow || (is_explicit && element == ElementOrder::kQuadratic)) {
      scene.duration /= 4;
      scene.output.frame_interval /= 4;
    }
    return scene;
  }
};

TEST_P(DeterminismTest, AnyNumberOfThreads) {
  const Scene scene = SceneOf();
  const RunResult reference = RunScene(scene, 1);
  ASSERT_EQ(reference.outcome.kind, Outcome::Kind::kSucceeded) << reference.outcome.failure.message;
  ASSERT_EQ(reference.frames.size(), 9u);
  EXPECT_NE(reference.frames[0].digest, reference.frames[8].digest);
  for (const int threads : {2, 4}) {
    EXPECT_EQ(DigestsOf(RunScene(scene, threads).frames), DigestsOf(reference.frames)) << threads << " threads";
  }
}

// Restored at random frames, each time with a different number of threads and from the checkpoint of a restored run.
TEST_P(DeterminismTest, CheckpointAndRestart) {
  const Scene scene = SceneOf();
  const RunResult reference = RunScene(scene, 2);
  std::mt19937 random(static_cast<unsigned>(std::get<0>(GetParam())) + 1);
  std::string checkpoint = reference.checkpoints[random() % 3];
  for (int restart = 0; restart < 3; ++restart) {
    Simulation simulation(std::make_shared<Scene>(scene), 1 + restart);
    ASSERT_TRUE(simulation.Restore(checkpoint));
    const auto first = static_cast<std::size_t>(simulation.next_frame());
    CollectingSink sink;
    EXPECT_EQ(simulation.Run(sink, {}, std::chrono::milliseconds(0)).kind, Outcome::Kind::kSucceeded);
    ASSERT_EQ(sink.frames.size(), reference.frames.size() - first);
    for (std::size_t i = 0; i < sink.frames.size(); ++i) {
      EXPECT_EQ(sink.frames[i].index, static_cast<std::int64_t>(first + i));
      EXPECT_EQ(sink.frames[i].digest, reference.frames[first + i].digest) << "frame " << first + i;
    }
    checkpoint = sink.checkpoints[random() % 2];
  }
}

// The digest depends on every bit of a frame.
TEST(DigestTest, ChangesWithAnyPart) {
  const Frame frame = RunScene(BusyScene(Stepping::kExplicit, ElementOrder::kLinear, 8), 2).frames[1];
  EXPECT_EQ(DigestOf(frame), frame.digest);
  const auto changed = [&](const auto& change) {
    Frame copy = frame;
    change(copy);
    return DigestOf(copy) != frame.digest;
  };
  EXPECT_TRUE(changed([](Frame& f) { ++f.index; }));
  EXPECT_TRUE(changed([](Frame& f) { f.time = std::nextafter(f.time, 1); }));
  EXPECT_TRUE(changed([](Frame& f) { ++f.step; }));
  EXPECT_TRUE(changed([](Frame& f) { f.bodies[1].positions[7][2] = std::nextafter(f.bodies[1].positions[7][2], 1); }));
  EXPECT_TRUE(changed([](Frame& f) { f.bodies[0].fields[1].name += "_"; }));
  EXPECT_TRUE(changed([](Frame& f) { f.bodies[0].fields[2].values[0] += 1e-12; }));
  EXPECT_TRUE(changed([](Frame& f) { f.series.back() += 1e-12; }));
}

#ifdef FASCICLE_SANITIZED
INSTANTIATE_TEST_SUITE_P(Steppings, DeterminismTest,
                         ::testing::Combine(::testing::Values(Stepping::kExplicit, Stepping::kMixed,
                                                              Stepping::kQuasiStatic),
                                            ::testing::Values(ElementOrder::kLinear)));
#else
INSTANTIATE_TEST_SUITE_P(Steppings, DeterminismTest,
                         ::testing::Combine(::testing::Values(Stepping::kExplicit, Stepping::kMixed,
                                                              Stepping::kBackwardEuler, Stepping::kNewmark,
                                                              Stepping::kBdf2, Stepping::kQuasiStatic),
                                            ::testing::Values(ElementOrder::kLinear, ElementOrder::kQuadratic)));
#endif

}  // namespace
}  // namespace fascicle
