// A block of muscle that flexodeal has solved: stretched, activated, and shortened while active.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>
#include <utility>

#include "tests/support/static_run.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;

// 30 x 10 x 10 mm with fibres at 30 degrees to its length, both ends glued. Its length grows by 10 % until 0.1 s, stays
// until 0.3 s while the activation rises from 0 to 1, and falls to 90 % at 0.5 s. Forces along the length, without
// inertia, from flexodeal (quadratic hexahedra with linear pressures) with the curves, matrix and bulk modulus of
// [Almonacid et al. 2024]; flexodeal's volume energy K/4 (J^2 - 1 - 2 ln J) is ours to second order in J - 1, which is
// below 0.01 here.
constexpr double kGrading = 0.8;
Scene FlexodealBlock(const std::array<int, 3>& divisions) {
  constexpr double kStress = 2e5;  // [Pa]
  const std::array values = {0.1990559575103343 * kStress, 0.3662334826469149 * kStress, 0.0, 1e7, kStress, 1.0, 0.0};
  const auto curves = std::make_shared<const MuscleCurves>(CurvesOf(PublishedCurves::kAlmonacid2024));
  // Elements are thinner near the sides, for the stress at the edges of the glued ends: at 0.5 s its error is largest.
  const Vec3 size(0.03, 0.01, 0.01);
  TetMesh mesh = MakeBox(Vec3::Zero(), size, divisions);
  for (Vec3& X : mesh.nodes) {
    for (int c = 0; c < 3; ++c) {
      constexpr double kTurn = 2 * std::numbers::pi;
      X[c] -= size[c] * kGrading / kTurn * std::sin(kTurn * X[c] / size[c]);
    }
  }
  Body body = MakeBody("block", std::move(mesh), TabulatedMuscle(values, curves));
  const double angle = std::numbers::pi / 6;
  body.tet().fibres = ConstantFibres(body.tet().mesh, Vec3(std::cos(angle), 0, std::sin(angle)));
  body.activation = {{0.1, 0.3}, {0, 1}, Curve::Interpolation::kLinear};
  Constraint end = Fix(kX1);
  end.motion.translation[0] = {{0, 0.1, 0.3, 0.5}, {0, 0.003, 0.003, -0.003}, Curve::Interpolation::kLinear};
  body.constraints = {Fix(kX0), end};
  Scene scene = StaticScene(std::move(body), ElementOrder::kQuadratic);
  scene.duration = 0.5;
  return scene;
}

TEST(FlexodealTest, PennateBlock) {
  constexpr std::array kTimes = {0.1, 0.2, 0.3, 0.4, 0.5};
  constexpr std::array kForces = {2.71, 10.13, 17.27, 11.16, 3.68};  // [N], as printed
  SteppedRun run(FlexodealBlock({12, 8, 8}));
  for (std::size_t i = 0; i < kTimes.size(); ++i) {
    ASSERT_TRUE(run.To(kTimes[i])) << kTimes[i];
    const double force = run.Reaction(1)[0];
    std::printf("%.1f s: %.4f N, flexodeal %.2f N, %+.2f %%\n", kTimes[i], force, kForces[i],
                100 * (force / kForces[i] - 1));
    EXPECT_NEAR(force, kForces[i], 0.01 * kForces[i]);
    EXPECT_NEAR(run.Reaction(0)[0], -force, 1e-6 * force);
  }
}

}  // namespace
}  // namespace fascicle
