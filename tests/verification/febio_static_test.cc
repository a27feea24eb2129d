// The FEBio reference problems, quasi-static with default settings: figures and fields.
#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

#include "tests/support/reference_file.h"
#include "tests/support/reference_problems.h"
#include "tests/support/static_run.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;

constexpr ElementOrder kLinear = ElementOrder::kLinear, kQuadratic = ElementOrder::kQuadratic,
                       kHexahedral = ElementOrder::kHexahedral;

const char* LabelOf(ElementOrder element) {
  return element == kHexahedral ? "hexahedral" : element == kQuadratic ? "quadratic" : "linear";
}

// Prints a figure beside its reference, and checks its relative error.
void Compare(const SteppedRun& run, const std::string& what, double ours, double reference, double part) {
  std::printf("%s, %s, %zu free components: %.7g, reference %.7g (%+.2g %%); %lld iterations\n", what.c_str(),
              LabelOf(run.model.order()), run.FreeComponents(), ours, reference, 100 * (ours / reference - 1),
              static_cast<long long>(run.state.iterations));
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
    // The file has eight digits of lengths up to 100 mm.
    ASSERT_LT((run.model.rest_positions()[ours] - 1e-3 * X).norm(), 1e-9);
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

// FEBio's own hexahedra, on the same meshes: "three-field" where the law is nearly incompressible, which is mean
// dilatation. The issue asks for 0.2 %; both solve the same equations, so figures agree to the digits of the reference.
constexpr double kSame = 2e-5;

// A run of the reference by its name.
const nlohmann::json& RunOf(const nlohmann::json& runs, const std::string& name) {
  const auto run =
      std::find_if(runs.begin(), runs.end(), [&](const nlohmann::json& r) { return r.at("name") == name; });
  if (run == runs.end()) throw std::runtime_error("the reference has no run " + name);
  return *run;
}

Scene HexahedralScene(Body body) { return StaticScene(std::move(body), kHexahedral); }

TEST(FebioHexahedraTest, NeoHookeanCantilever) {
  const auto reference = ReadReference("a_cantilever_neohookean");
  if (!reference) GTEST_SKIP() << NoReference();
  for (const int n : {2, 4}) {
    const std::string name = "a_hex8_" + std::to_string(10 * n);
    SteppedRun run(HexahedralScene(NeoHookeanCantilever(n, Ramp(1), Cells::kHexahedra)));
    ASSERT_TRUE(run.To(1));
    const nlohmann::json& theirs = RunOf(reference->at("runs"), name);
    ASSERT_EQ(run.FreeComponents(), theirs.at("free_dofs"));
    Compare(run, name + ": tip [mm]", TipOf(run), theirs.at("tip_center_displacement")[2], kSame);
    Compare(run, name + ": volume", 10 * VolumeRatiosOf(run.model, 0, run.state.positions).total,
            theirs.at("volume_final"), 1e-8);
  }
}

TEST(FebioHexahedraTest, StretchedCube) {
  const auto reference = ReadReference("b_uniaxial_mooney_rivlin");
  if (!reference) GTEST_SKIP() << NoReference();
  Body body = ClampedCube(2, NearlyIncompressible(), Ramp(0.005), Cells::kHexahedra);
  body.constraints[0].axes = body.constraints[1].axes = {false, false, true};
  body.constraints.push_back(Fix(kX0, {true, false, false}));
  body.constraints.push_back(Fix(kY0, {false, true, false}));
  SteppedRun free_sides(HexahedralScene(body));
  ASSERT_TRUE(free_sides.To(1));
  Compare(free_sides, "b homogeneous: force [N]", free_sides.Reaction(1)[2], 7.7368966, 1e-7);
  Compare(free_sides, "b homogeneous: J", VolumeRatiosOf(free_sides.model, 0, free_sides.state.positions).total,
          1.000483673, 1e-8);
  for (const int n : {4, 8}) {
    const std::string name = "b_clamp_hex8_" + std::to_string(n) + "_def";
    SteppedRun run(HexahedralScene(ClampedCube(n, NearlyIncompressible(), Ramp(0.005), Cells::kHexahedra)));
    ASSERT_TRUE(run.To(1));
    const nlohmann::json& theirs = RunOf(reference->at("runs_clamped"), name);
    Compare(run, name + ": force [N]", run.Reaction(1)[2], theirs.at("path_t_Fz").back()[1], kSame);
    Compare(run, name + ": volume", 1000 * VolumeRatiosOf(run.model, 0, run.state.positions).total,
            theirs.at("volume_final"), 1e-7);
  }
}

TEST(FebioHexahedraTest, IsometricMuscle) {
  const auto reference = ReadReference("d_fusiform_isometric");
  if (!reference) GTEST_SKIP() << NoReference();
  for (const int n : {4, 8}) {
    const std::string name = "d_hex8_" + std::to_string(n) + "_def";
    const nlohmann::json& theirs = RunOf(reference->at("runs"), name);
    SteppedRun run(HexahedralScene(ReferenceMuscle(n, Ramp(1), Cells::kHexahedra)));
    ASSERT_EQ(run.FreeComponents(), theirs.at("free_dofs"));
    for (const int tenths : {2, 5, 10}) {
      ASSERT_TRUE(run.To(0.1 * tenths));
      const nlohmann::json& row = theirs.at("path_activation_Fz_at_z1_Fz_at_z0")[static_cast<std::size_t>(tenths)];
      Compare(run, name + " at " + row[0].dump() + ": end force [N]", run.Reaction(1)[2], row[1], kSame);
    }
    Compare(run, name + ": belly [mm]", 1e3 * run.DisplacementAt(kMuscleBelly)[0], theirs.at("probe_ux_path").back()[1],
            kSame);
    Compare(run, name + ": axis [mm]", 1e3 * run.DisplacementAt(Vec3(0, 0, 0.025))[2], theirs.at("probe2_uz_final"),
            kSame);
  }
}

TEST(FebioHexahedraTest, NearlyIncompressibleCantilever) {
  const auto reference = ReadReference("f_bending_locking");
  if (!reference) GTEST_SKIP() << NoReference();
  for (const int n : {2, 4}) {
    const std::string name = "f_hex8_" + std::to_string(10 * n) + "_def";
    SteppedRun run(HexahedralScene(LockingCantilever(n, Ramp(1), Cells::kHexahedra)));
    ASSERT_TRUE(run.To(1));
    Compare(run, name + ": tip [mm]", TipOf(run), RunOf(reference->at("runs"), name).at("tip_center_displacement")[2],
            kSame);
  }
}

// Without the mean dilatation, as FEBio's displacement-only element.
TEST(FebioHexahedraTest, LockingHexahedra) {
  const auto reference = ReadReference("f_bending_locking");
  if (!reference) GTEST_SKIP() << NoReference();
  Scene scene = HexahedralScene(LockingCantilever(2, Ramp(1), Cells::kHexahedra));
  scene.tet.volume = VolumeForm::kElement;
  SteppedRun run(scene);
  ASSERT_TRUE(run.To(1));
  const nlohmann::json& theirs = RunOf(reference->at("runs"), "f_hex8_20_elastic-solid");
  Compare(run, "f_hex8_20_elastic-solid: tip [mm]", TipOf(run), theirs.at("tip_center_displacement")[2], kSame);
}

TEST(FebioHexahedraTest, NodeByNode) {
  CompareField(HexahedralScene(NeoHookeanCantilever(2, Ramp(1), Cells::kHexahedra)), "a_cantilever_neohookean",
               "full_fields_coarsest_mesh", "hex8", "a_hex8_20", kSame);
  CompareField(HexahedralScene(ClampedCube(4, NearlyIncompressible(), Ramp(0.005), Cells::kHexahedra)),
               "b_uniaxial_mooney_rivlin", "full_fields_clamped_coarse", "hex8", "b_clamp_hex8_4_def", kSame);
  CompareField(HexahedralScene(ReferenceMuscle(4, Ramp(1), Cells::kHexahedra)), "d_fusiform_isometric",
               "full_fields_coarse", "hex8", "d_hex8_4_def", kSame);
  CompareField(HexahedralScene(LockingCantilever(2, Ramp(1), Cells::kHexahedra)), "f_bending_locking",
               "full_fields_coarse", "hex8", "f_hex8_20_def", kSame);
}

}  // namespace
}  // namespace fascicle
