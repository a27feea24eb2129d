// Quasi-static states of large deformation against closed forms.
#include <gtest/gtest.h>

#include <numbers>
#include <set>
#include <vector>

#include "core/materials/uniaxial_curve.h"
#include "tests/support/reference_problems.h"
#include "tests/support/static_run.h"
#include "twisted_rod.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;

const Muscle kMuscle(std::array{500.0, 500.0, 1e6, 3e5, 1.2, 0.05, 6.6, 1.4});

// The stretch at which an unloaded active body comes to rest along its fibres.
UniaxialPoint FreeContraction(const Material& law, double activation) {
  double low = 0.3, high = 1;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (UniaxialTension(law, activation, middle).nominal_stress < 0 ? low : high) = middle;
  }
  return UniaxialTension(law, activation, low);
}

TEST(ContractionTest, MuscleWithAFreeEnd) {
  for (const ElementOrder element : {ElementOrder::kLinear, ElementOrder::kQuadratic}) {
    Body body = BoxBody(Vec3(0.01, 0.01, 0.04), {2, 2, 4}, kMuscle);
    body.tet().fibres = ConstantFibres(body.tet().mesh, Vec3::UnitZ());
    body.constraints = {Fix(kX0, {true, false, false}), Fix(kY0, {false, true, false}), Fix(kZ0, {false, false, true})};
    body.activation = Ramp(0.5);
    SteppedRun run(StaticScene(body, element));
    ASSERT_TRUE(run.To(1));
    const UniaxialPoint exact = FreeContraction(kMuscle, 0.5);
    std::printf("stretch %.5f, J %.6f; %lld iterations\n", exact.stretch, exact.volume_ratio,
                static_cast<long long>(run.state.iterations));
    EXPECT_LT(exact.stretch, 0.8);
    for (std::size_t n = 0; n < run.model.nodes(); ++n) {
      const Vec3& X = run.model.rest_positions()[n];
      const Vec3 x(exact.lateral_stretch * X[0], exact.lateral_stretch * X[1], exact.stretch * X[2]);
      EXPECT_LT((run.state.positions[n] - x).norm(), 1e-6 * 0.04);
    }
  }
}

// Supported at three points only, it contracts along its fibres, 30 degrees off its axis: x = R U X with a known U and
// any rotation R.
TEST(ContractionTest, BarWithFibresAcross) {
  for (const ElementOrder element : {ElementOrder::kLinear, ElementOrder::kQuadratic}) {
    const Vec3 fibre(0.5, 0, std::sqrt(0.75));
    Body body = BoxBody(Vec3(0.01, 0.01, 0.04), {2, 2, 4}, kMuscle);
    body.tet().fibres = ConstantFibres(body.tet().mesh, fibre);
    body.regions.push_back({"origin", {0}, {}, {}, {}});
    body.regions.push_back({"along_x", {2}, {}, {}, {}});
    body.regions.push_back({"along_y", {6}, {}, {}, {}});
    body.constraints = {{6, {true, true, true}, {}}, {7, {false, true, true}, {}}, {8, {false, false, true}, {}}};
    body.activation = Ramp(0.5);
    SteppedRun run(StaticScene(body, element));
    ASSERT_TRUE(run.To(1));
    const UniaxialPoint exact = FreeContraction(kMuscle, 0.5);
    const Mat3 U =
        exact.lateral_stretch * Mat3::Identity() + (exact.stretch - exact.lateral_stretch) * fibre * fibre.transpose();
    const NodalVector& X = run.model.rest_positions();
    const NodalVector& x = run.state.positions;
    for (std::size_t n = 1; n < X.size(); ++n) {
      for (const std::size_t m : {std::size_t{0}, std::size_t{2}, std::size_t{6}, n - 1}) {
        EXPECT_NEAR((x[n] - x[m]).norm(), (U * (X[n] - X[m])).norm(), 1e-6 * 0.04);
      }
    }
  }
}

// A bar with free sides is stretched or shortened along its fibres, by laws that stiffen: the force of the support is
// the nominal stress, and every node moves with the homogeneous gradient.
TEST(StretchTest, BarOfStiffeningLaws) {
  const std::vector<Material> laws = {Yeoh(std::array{3e4, -1e3, 2e2, 1e8}),
                                      Ogden(std::array{6e4, 1.3, 600.0, 5.0, 2e3, -2.0, 1e8}),
                                      FungFibre(std::array{1e4, 5e3, 2e4, 2.0, 1e8}),
                                      HolzapfelGasserOgden(std::array{1e4, 2e4, 3.0, 0.15, 0.6, 1.0, 0.0, 0.0, 1e8})};
  for (const Material& law : laws) {
    for (const ElementOrder element : {ElementOrder::kLinear, ElementOrder::kQuadratic}) {
      for (const double stretch : {0.7, 1.6}) {
        Body body = BoxBody(Vec3(0.01, 0.01, 0.04), {2, 2, 4}, law);
        body.tet().fibres = ConstantFibres(body.tet().mesh, Vec3::UnitZ());
        Constraint pull = Fix(kZ1, {false, false, true});
        pull.motion.translation[2] = Ramp((stretch - 1) * 0.04);
        body.constraints = {Fix(kX0, {true, false, false}), Fix(kY0, {false, true, false}),
                            Fix(kZ0, {false, false, true}), pull};
        SteppedRun run(StaticScene(body, element));
        ASSERT_TRUE(run.To(1));
        const UniaxialPoint exact = UniaxialTension(law, 0, stretch);
        ASSERT_TRUE(exact.converged);
        const double nominal = run.Reaction(3)[2] / (0.01 * 0.01);
        std::printf("%-24s %d stretch %.1f: %.9g Pa, exact %.9g; %lld iterations\n",
                    std::visit([](const auto& l) { return l.kName; }, law), static_cast<int>(element), stretch, nominal,
                    exact.nominal_stress, static_cast<long long>(run.state.iterations));
        EXPECT_NEAR(nominal, exact.nominal_stress, 1e-6 * std::abs(exact.nominal_stress));
        for (std::size_t n = 0; n < run.model.nodes(); ++n) {
          const Vec3& X = run.model.rest_positions()[n];
          const Vec3 x(exact.lateral_stretch * X[0], exact.lateral_stretch_y * X[1], exact.stretch * X[2]);
          EXPECT_LT((run.state.positions[n] - x).norm(), 1e-6 * 0.04);
        }
      }
    }
  }
}

// A round rod with a curved surface, twisted at constant length [Rivlin 1948]: the torque and the axial force of an
// incompressible Mooney-Rivlin law, which K/mu = 1000 approximates.
TEST(TorsionTest, RoundRod) {
  const double c1 = 0.03e6, c2 = 0.01e6;
  const double twist = kRodAngle / kRodLength, fourth = std::pow(kRodRadius, 4);
  const RodForces exact{.torque = std::numbers::pi * twist * fourth * (c1 + c2),
                        .axial = -0.5 * std::numbers::pi * twist * twist * fourth * (c1 + 2 * c2)};
  const RodForces found = TwistRod(MakeBody("rod", RodMesh(), NearlyIncompressible()), 0, exact);
  EXPECT_NEAR(found.torque, exact.torque, 0.01 * exact.torque);
  EXPECT_NEAR(found.axial, exact.axial, 0.02 * std::abs(exact.axial));
}

}  // namespace
}  // namespace fascicle
