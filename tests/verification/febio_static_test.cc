// The FEBio reference problems, quasi-static with default settings: figures and fields.
#include <gtest/gtest.h>

#include "tests/support/reference_file.h"
#include "tests/support/reference_problems.h"
#include "tests/support/static_run.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;

constexpr ElementOrder kLinear = ElementOrder::kLinear, kQuadratic = ElementOrder::kQuadratic;

// Prints a figure beside its reference, and checks its relative error.
void Compare(const SteppedRun& run, const std::string& what, double ours, double reference, double part) {
  std::printf("%s, %s, %zu free components: %.5g, reference %.5g (%+.2f %%); %lld iterations\n", what.c_str(),
              run.model.order() == kQuadratic ? "quadratic" : "linear", run.FreeComponents(), ours, reference,
              100 * (ours / reference - 1), static_cast<long long>(run.state.iterations));
  EXPECT_NEAR(ours, reference, part * std::abs(reference)) << what;
}

// Moment of the support at x = 0 about the middle of its face at rest, along y [N mm].
double MomentOf(SteppedRun& run) {
  const Reaction reaction = run.solver.ReactionsWithMoments(run.state).at(0);
  return 1e3 * (reaction.moment - Vec3(0, 0.0005, 0.0005).cross(reaction.force)).y();
}

double TipOf(const SteppedRun& run) { return 1e3 * run.DisplacementAt(kCantileverTip)[2]; }

TEST(FebioStaticTest, NeoHookeanCantilever) {
  SteppedRun run(StaticScene(NeoHookeanCantilever(2, Ramp(1)), kQuadratic));
  ASSERT_TRUE(run.To(1));
  EXPECT_EQ(run.FreeComponents(), 3000u);
  Compare(run, "a: tip [mm]", TipOf(run), -3.498, 0.005);
  Compare(run, "a: moment [N mm], the same mesh", MomentOf(run), -9.2436603, 2e-4);
}

TEST(FebioStaticTest, StretchedCubeWithFreeSides) {
  for (const ElementOrder element : {kLinear, kQuadratic}) {
    Body body = ClampedCube(2, NearlyIncompressible(), Ramp(0.005));
    body.constraints[0].axes = body.constraints[1].axes = {false, false, true};
    body.constraints.push_back(Fix(kX0, {true, false, false}));
    body.constraints.push_back(Fix(kY0, {false, true, false}));
    SteppedRun run(StaticScene(body, element));
    ASSERT_TRUE(run.To(1));
    Compare(run, "b homogeneous: force [N]", run.Reaction(1)[2], 7.7368966, 1e-6);
    Compare(run, "b homogeneous: J", VolumeRatiosOf(run.model, 0, run.state.positions).total, 1.0004837, 1e-6);
  }
}

TEST(FebioStaticTest, StretchedCubeWithClampedEnds) {
  const auto check = [](ElementOrder element, double part) {
    SteppedRun run(StaticScene(ClampedCube(8, NearlyIncompressible(), Ramp(0.005)), element));
    ASSERT_TRUE(run.To(1));
    Compare(run, "b clamped: force [N]", run.Reaction(1)[2], 9.21, part);
  };
  check(kQuadratic, 0.015);
  check(kLinear, 0.06);
}

TEST(FebioStaticTest, IsometricMuscle) {
  SteppedRun run(StaticScene(ReferenceMuscle(4, Ramp(1)), kQuadratic));
  EXPECT_EQ(run.FreeComponents(), 7533u);
  for (const auto& [activation, force] : {std::pair{0.2, 17.40}, std::pair{0.5, 39.96}, std::pair{1.0, 70.0}}) {
    ASSERT_TRUE(run.To(activation));
    Compare(run, "d at activation " + std::to_string(activation) + ": end force [N]", run.Reaction(1)[2], force, 0.01);
  }
  Compare(run, "d: belly [mm]", 1e3 * run.DisplacementAt(kMuscleBelly)[0], 2.357, 0.02);
}

TEST(FebioStaticTest, IsometricMuscleOfLinearElements) {
  SteppedRun run(StaticScene(ReferenceMuscle(8, Ramp(1)), kLinear));
  ASSERT_TRUE(run.To(1));
  Compare(run, "d: end force [N]", run.Reaction(1)[2], 70.0, 0.03);
}

TEST(FebioStaticTest, NearlyIncompressibleCantilever) {
  const auto check = [](ElementOrder element, int n, double part) {
    SteppedRun run(StaticScene(LockingCantilever(n, Ramp(1)), element));
    ASSERT_TRUE(run.To(1));
    Compare(run, "f: tip [mm]", TipOf(run), -5.53, part);
  };
  check(kQuadratic, 2, 0.025);
  check(kQuadratic, 3, 0.01);
  check(kLinear, 4, 0.2);
}

// The same mesh, elements and loads as one of FEBio's runs: the displacement of every node.
void CompareField(const Scene& scene, const std::string& file, const std::string& key, const std::string& element,
                  const std::string& name, double part) {
  const auto reference = ReadReference(file);
  if (!reference) GTEST_SKIP() << NoReference();
  const nlohmann::json& field = reference->at(key).at(element);
  ASSERT_EQ(field.at("run"), name);
  SteppedRun run(scene);
  ASSERT_TRUE(run.To(1));
  const auto& coordinates = field.at("node_coordinates");
  const auto& displacements = field.at("displacement_final");
  ASSERT_EQ(coordinates.size(), run.model.nodes());
  double largest = 0;
  for (const nlohmann::json& row : displacements) largest = std::max(largest, 1e-3 * std::abs(row[2].get<double>()));
  double difference = 0;
  for (std::size_t n = 0; n < coordinates.size(); ++n) {
    const Vec3 X(coordinates[n][0], coordinates[n][1], coordinates[n][2]);
    const Vec3 u(displacements[n][0], displacements[n][1], displacements[n][2]);
    const std::size_t ours = run.NodeAt(1e-3 * X);
    ASSERT_LT((run.model.rest_positions()[ours] - 1e-3 * X).norm(), 1e-10);
    difference = std::max(difference, (run.Displacement(ours) - 1e-3 * u).norm());
  }
  std::printf("%s: largest difference of a node %.3g %% of the deflection, %.6g mm\n", name.c_str(),
              100 * difference / largest, 1e3 * largest);
  EXPECT_LT(difference, part * largest);
}

TEST(FebioStaticTest, QuadraticElementsNodeByNode) {
  CompareField(StaticScene(NeoHookeanCantilever(2, Ramp(1)), kQuadratic), "a_cantilever_neohookean",
               "full_fields_coarsest_mesh", "tet10", "a_tet10_20", 0.001);
}

// Linear elements with their own volume ratios lock as FEBio's do.
TEST(FebioStaticTest, LockingElementsNodeByNode) {
  Scene scene = StaticScene(LockingCantilever(2, Ramp(1)), kLinear);
  scene.tet.volume = VolumeForm::kElement;
  CompareField(scene, "f_bending_locking", "full_fields_coarse", "tet4", "f_tet4_20_def", 0.005);
}

}  // namespace
}  // namespace fascicle
