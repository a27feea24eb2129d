// Warnings of runs that are made to deserve them, and none of runs that do not.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/brick_bodies.h"
#include "tests/support/static_run.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::vector<std::string> ReasonsOf(const RunResult& run) {
  std::vector<std::string> reasons;
  for (const Warning& warning : run.outcome.warnings) reasons.push_back(warning.reason);
  return reasons;
}

// A bar between two ends, of which one moves along x by a part of the length.
Scene StretchedBar(Material material, double part, double frame_interval = 1) {
  Body body = BoxBody(Vec3(0.04, 0.01, 0.01), {4, 2, 2}, std::move(material));
  body.tet().fibres = ConstantFibres(body.tet().mesh, Vec3::UnitX());
  Constraint end = Fix(kX1, {true, false, false});
  end.motion.translation[0] = Ramp(0.04 * part);
  body.constraints = {Fix(kX0, {true, false, false}), Fix(kY0, {false, true, false}), Fix(kZ0, {false, false, true}),
                      end};
  Scene scene = StaticScene(std::move(body), ElementOrder::kLinear);
  scene.output.frame_interval = frame_interval;
  return scene;
}

Material Rubber() { return MooneyRivlin(std::array{2e3, 1e3, 2e6}); }

TEST(RunWarningsTest, NoneOfAnOrdinaryRun) { EXPECT_THAT(ReasonsOf(RunScene(StretchedBar(Rubber(), 0.2))), IsEmpty()); }

TEST(RunWarningsTest, AStepThatHalvesTheLength) {
  const RunResult run = RunScene(StretchedBar(Rubber(), -0.5));
  ASSERT_THAT(ReasonsOf(run), ElementsAre("LARGE_STEP"));
  EXPECT_THAT(run.outcome.warnings[0].message, HasSubstr("a single step changes lengths"));
  EXPECT_THAT(run.outcome.warnings[0].message, HasSubstr("by a factor of 2.00"));
  EXPECT_EQ(run.outcome.warnings[0].body, "box");
  EXPECT_EQ(run.outcome.warnings[0].time, 1);
  EXPECT_THAT(ReasonsOf(RunScene(StretchedBar(Rubber(), -0.5, 0.25))), IsEmpty());
}

// A muscle whose bulk modulus is too small for its activation.
TEST(RunWarningsTest, AnElementThatGrows) {
  Body body = BoxBody(Vec3(0.04, 0.01, 0.01), {4, 2, 2}, Muscle(std::array{5e2, 5e2, 1e5, 3e5, 1.2, 0.05, 6.6, 1.0}));
  body.tet().fibres = ConstantFibres(body.tet().mesh, Vec3::UnitX());
  body.constraints = {Fix(kX0), Fix(kX1)};
  body.activation = Ramp(1);
  const RunResult run = RunScene(StaticScene(std::move(body), ElementOrder::kLinear));
  ASSERT_THAT(ReasonsOf(run), ::testing::Contains("VOLUME_RATIO"));
  const Warning& warning = run.outcome.warnings[0];
  EXPECT_THAT(warning.message, HasSubstr("although its law is nearly incompressible"));
  ASSERT_EQ(warning.elements.size(), 1u);
  EXPECT_THAT(warning.message, HasSubstr("element " + std::to_string(warning.elements[0])));
}

// A compressible law may change its volume.
TEST(RunWarningsTest, NoneOfACompressibleLaw) {
  EXPECT_THAT(ReasonsOf(RunScene(StretchedBar(NeoHookean(std::array{1e4, 0.2}), 0.45))), IsEmpty());
}

TEST(RunWarningsTest, FibresBeyondTheirRange) {
  const Material muscle = Muscle(std::array{5e3, 5e3, 1e7, 3e4, 1.2, 0.05, 6.6, 1.4});
  const RunResult run = RunScene(StretchedBar(muscle, 0.7, 0.25));
  ASSERT_THAT(ReasonsOf(run), ElementsAre("FIBRE_STRETCH"));
  EXPECT_THAT(run.outcome.warnings[0].message, HasSubstr("lengthen to a stretch of 1.70"));
  EXPECT_THAT(ReasonsOf(RunScene(StretchedBar(muscle, 0.5, 0.25))), IsEmpty());
}

TEST(RunWarningsTest, LinearElasticityStretched) {
  Body body = VoxelBox(Vec3(0.04, 0.01, 0.01), {8, 2, 2}, LinearElastic(std::array{1e4, 0.3}));
  body.constraints = {{0, {true, true, true}, {}}};
  body.loads.push_back({1, Traction{Vec3(2e3, 0, 0)}, Curve::Constant(1), {}});
  const RunResult run = RunScene(VoxelScene(std::move(body)));
  ASSERT_THAT(ReasonsOf(run), ElementsAre("STRAIN"));
  EXPECT_THAT(run.outcome.warnings[0].message, HasSubstr("but the law is linear"));
}

// Backward Euler with long steps damps a swinging cantilever, which no work accounts for.
TEST(RunWarningsTest, EnergyThatALongStepLoses) {
  Body body = BoxBody(Vec3(0.04, 0.01, 0.01), {4, 1, 1}, NeoHookean(std::array{1e4, 0.3}));
  body.constraints = {Fix(kX0)};
  body.loads.push_back({kX1, Traction{Vec3(0, 0, -10)}, Curve::Constant(1), {}});
  Scene scene = OneBody(std::move(body));
  scene.duration = 0.5;
  scene.tet.stepping = Stepping::kBackwardEuler;
  scene.tet.time_step = 0.01;
  ASSERT_THAT(ReasonsOf(RunScene(scene)), ElementsAre("ENERGY"));
  scene.tet.stepping = Stepping::kExplicit;
  scene.tet.time_step = {};
  EXPECT_THAT(ReasonsOf(RunScene(scene)), IsEmpty());
}

// A run that continues from a checkpoint after the worst frame warns of it.
TEST(RunWarningsTest, SurviveARestart) {
  Scene scene = StretchedBar(Rubber(), -0.5, 0.25);
  scene.bodies[0].constraints[3].motion.translation[0] =
      Curve{{0, 0.25, 1}, {0, -0.02, -0.02}, Curve::Interpolation::kLinear};
  const RunResult whole = RunScene(scene);
  ASSERT_THAT(ReasonsOf(whole), ElementsAre("LARGE_STEP"));
  Simulation restarted(std::make_shared<Scene>(scene), 1);
  ASSERT_TRUE(restarted.Restore(whole.checkpoints.at(2)));
  CollectingSink sink;
  const Outcome outcome = restarted.Run(sink, {});
  ASSERT_EQ(outcome.warnings.size(), 1u);
  EXPECT_EQ(outcome.warnings[0].message, whole.outcome.warnings[0].message);
  EXPECT_EQ(outcome.warnings[0].time, 0.25);
}

}  // namespace
}  // namespace fascicle
