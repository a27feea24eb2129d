// Fields of the tet method: under affine and quadratic deformations, and against sums that they must add up to.
#include "core/tet/fields.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "core/scene/probe_place.h"
#include "tests/support/static_run.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;

double VolumeOfElement(const TetMesh& mesh, std::size_t e) {
  if (mesh.hexahedra.empty()) return SignedVolume(mesh, e);
  double volume = 0;
  for (std::size_t t = 6 * e; t < 6 * e + 6; ++t) volume += SignedVolume(mesh, t);
  return volume;
}

Material MuscleLaw() { return Muscle(std::array{5e2, 5e2, 1e5, 3e4, 1.2, 0.05, 6.6, 1.4}); }

class TetFieldsTest : public ::testing::TestWithParam<ElementOrder> {
 protected:
  // A block of muscle in a given state.
  struct Block {
    explicit Block(ElementOrder order) : run(SceneOf(order)) {
      controls.activations = {0.6};
      controls.motions.resize(2);
    }
    static Scene SceneOf(ElementOrder order) {
      Body body = BoxBody(Vec3(0.03, 0.02, 0.02), {3, 2, 2}, MuscleLaw(), CellsOf(order));
      body.constraints = {Fix(kX0), Fix(kX1)};
      Scene scene = StaticScene(std::move(body), order);
      scene.output.line_of_action = Vec3::UnitX();
      return scene;
    }
    template <class Map>
    void Deform(const Map& map) {
      for (std::size_t n = 0; n < run.model.nodes(); ++n) run.state.positions[n] = map(run.model.rest_positions()[n]);
    }
    std::vector<double> Of(OutputField field) {
      return FieldValuesOf(run.model, 0, field, run.state, {controls, controls}, run.team);
    }
    std::vector<double> At(const Vec3& point, OutputField field) {
      return FieldValuesAt(run.model, ProbeAt(point), field, run.state, controls, run.team);
    }
    Probe ProbeAt(const Vec3& point) const { return LocateProbe("p", 0, run.scene.bodies[0].shape, point).probe; }

    SteppedRun run;
    Controls controls;
  };
};

// The formulas for the one deformation gradient and the law's own stress; nodal averages of J are J.
TEST_P(TetFieldsTest, OfAnAffineDeformationAreThoseOfItsGradient) {
  Block block(GetParam());
  const Mat3 R = Eigen::AngleAxisd(0.6, Vec3(1, 1, 0).normalized()).toRotationMatrix();
  for (const Vec3& stretches : {Vec3(1.1, 0.97, 0.95), Vec3(1.05, 1.05, 0.9), Vec3(1.02, 1.02, 1.02)}) {
    MaterialPoint at;
    at.F = R * stretches.asDiagonal();
    at.J = at.F.determinant();
    at.a0 = Vec3(1, 0.3, 0.2).normalized();
    block.Deform([&](const Vec3& X) -> Vec3 { return at.F * X + Vec3(0.1, 0, 0.3); });
    const Muscle law(std::array{5e2, 5e2, 1e5, 3e4, 1.2, 0.05, 6.6, 1.4});
    const auto cauchy = [&](double activation) -> Mat3 {
      return law.Stress(at.F, {at.a0, activation}) * at.F.transpose() / at.J;
    };
    at.sigma = cauchy(0.6);
    at.passive_sigma = cauchy(0);
    at.energy_density = law.Energy(at.F, {at.a0, 0.6});
    for (const OutputFieldInfo& info : OutputFields()) {
      if (IsNodal(info)) continue;
      std::vector<double> expected(info.components);
      PutField(info.field, at, expected.data());
      if (info.is_direction) NormalizeDirections(expected);
      const double scale = info.from == FieldSource::kDeformation ? 1 : 1e5;
      if (info.field == OutputField::kPrincipalStressDirections) continue;  // of either sign
      const std::vector<double> values = block.Of(info.field);
      ASSERT_EQ(values.size(), info.components * (IsHexahedral(GetParam()) ? 12 : 72));
      for (std::size_t i = 0; i < values.size(); ++i) {
        EXPECT_NEAR(values[i], expected[i % info.components], 1e-10 * scale) << info.name;
      }
      const std::vector<double> at_probe = block.At(Vec3(0.0123, 0.0041, 0.0177), info.field);
      for (std::size_t c = 0; c < info.components; ++c) {
        EXPECT_NEAR(at_probe[c], expected[c], 1e-10 * scale) << info.name;
      }
    }
  }
}

// The fibre's active part is the law's active stress, over J: the pressure of incompressibility does not change it.
TEST_P(TetFieldsTest, TheActivePartIsTheLawsActiveStress) {
  Block block(GetParam());
  block.Deform([](const Vec3& X) -> Vec3 { return {1.1 * X[0], 0.95 * X[1], 0.93 * X[2]}; });
  const Mat3 F = Vec3(1.1, 0.95, 0.93).asDiagonal();
  const Vec3 a0 = Vec3(1, 0.3, 0.2).normalized();
  const Muscle law(std::array{5e2, 5e2, 1e5, 3e4, 1.2, 0.05, 6.6, 1.4});
  const double stretch = (F * a0).norm() / std::cbrt(F.determinant());
  const double active = (law.FibreStress(stretch, 0.6) - law.FibreStress(stretch, 0)) / F.determinant();
  ASSERT_GT(active, 1e3);
  for (const double value : block.Of(OutputField::kActiveFibreStress)) EXPECT_NEAR(value, active, 1e-10 * active);
}

TEST_P(TetFieldsTest, EnergyDensityAddsUpToTheEnergy) {
  Block block(GetParam());
  block.Deform([](const Vec3& X) -> Vec3 {
    return X + Vec3(0.1 * X[0] + 3 * X[1] * X[1], -2 * X[0] * X[0], 0.05 * X[2] + 2 * X[0] * X[1]);
  });
  const double energy = ElasticEnergy(block.run.model, 0, FibreDrive{block.controls.activations},
                                      block.run.state.positions, block.run.team);
  ASSERT_GT(std::abs(energy), 1e-4);
  double sum = 0;
  const std::vector<double> densities = block.Of(OutputField::kStrainEnergyDensity);
  for (std::size_t e = 0; e < densities.size(); ++e) {
    sum += densities[e] * VolumeOfElement(block.run.scene.bodies[0].tet().mesh, e);
  }
  EXPECT_NEAR(sum, energy, 1e-12 * std::abs(energy));
}

// x = X + c X_0^2 e_x is represented exactly by quadratic elements: displacement and F at any point.
class QuadraticProbeTest : public ::testing::TestWithParam<ElementOrder> {};
INSTANTIATE_TEST_SUITE_P(Elements, QuadraticProbeTest,
                         ::testing::Values(ElementOrder::kQuadratic, ElementOrder::kHexahedralQuadratic),
                         [](const auto& element) { return ElementNameOf(element.param); });

TEST_P(QuadraticProbeTest, QuadraticElementsAreInterpolatedExactly) {
  Body body = BoxBody(Vec3(0.03, 0.02, 0.02), {3, 2, 2}, NeoHookean(std::array{1e4, 0.3}), CellsOf(GetParam()));
  body.constraints = {Fix(kX0)};
  SteppedRun run(StaticScene(std::move(body), GetParam()));
  for (std::size_t n = 0; n < run.model.nodes(); ++n) {
    const Vec3& X = run.model.rest_positions()[n];
    run.state.positions[n] = X + Vec3(5 * X[0] * X[0], 0, 0);
  }
  Controls controls;
  controls.activations = {0};
  for (const Vec3& X : {Vec3(0.0123, 0.0041, 0.0177), Vec3(0.0291, 0.0101, 0.0002), Vec3(0.02, 0.01, 0.01)}) {
    const Probe probe = LocateProbe("p", 0, run.scene.bodies[0].shape, X).probe;
    EXPECT_LT((DisplacementAt(run.model, probe, run.state) - Vec3(5 * X[0] * X[0], 0, 0)).norm(), 1e-16);
    const std::vector<double> J =
        FieldValuesAt(run.model, probe, OutputField::kVolumeRatio, run.state, controls, run.team);
    EXPECT_NEAR(J[0], 1 + 10 * X[0], 1e-12);
  }
}

// The nodal reactions add up to the reaction and its moment; internal forces add up to nothing.
TEST_P(TetFieldsTest, NodalForcesAddUp) {
  Body body = BoxBody(Vec3(0.03, 0.01, 0.01), {3, 1, 1}, NeoHookean(std::array{1e4, 0.3}), CellsOf(GetParam()));
  body.constraints = {Fix(kX0)};
  body.loads.push_back({kX1, Traction{Vec3(0, 0, -50)}, Ramp(1), {}});
  SteppedRun run(StaticScene(std::move(body), GetParam()));
  ASSERT_TRUE(run.To(1));
  Controls controls;
  controls.activations = {0};
  controls.load_scales = {1};
  controls.motions.resize(1);
  const auto sum_of = [&](OutputField field) {
    const std::vector<double> values = FieldValuesOf(run.model, 0, field, run.state, {controls, controls}, run.team);
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < values.size(); i += 3) sum += Vec3(values[i], values[i + 1], values[i + 2]);
    return sum;
  };
  EXPECT_LT((sum_of(OutputField::kReactionForce) - run.Reaction(0)).norm(), 1e-12);
  EXPECT_LT((sum_of(OutputField::kReactionForce) - Vec3(0, 0, 50e-4)).norm(), 1e-8);
  EXPECT_LT(sum_of(OutputField::kInternalForce).norm(), 1e-12);
}

INSTANTIATE_TEST_SUITE_P(Elements, TetFieldsTest, ::testing::ValuesIn(kEveryElement));

}  // namespace
}  // namespace fascicle
