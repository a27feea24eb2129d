// Bodies brought to rest, against closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "core/tet/diagnostics.h"
#include "tests/support/tet_scenes.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;

// A bar pulled along x, free to contract: three sides on rollers.
Scene PulledBar(const Material& law, double traction, double density = 1000) {
  Body body = BoxBody(Vec3(0.04, 0.02, 0.02), {4, 2, 2}, law);
  body.density = density;
  body.constraints = {Fix(kX0, {true, false, false}), Fix(kY0, {false, true, false}), Fix(kZ0, {false, false, true})};
  body.loads.push_back(
      {kX1, Traction{Vec3(traction, 0, 0)}, Curve{{0, 0.05}, {0, 1}, Curve::Interpolation::kSmooth}, {}});
  body.damping.mass_proportional = 150;
  Scene scene = OneBody(body);
  scene.output.settle_speed = 1e-9;
  scene.output.frame_interval = 0.02;
  scene.duration = 2;
  return scene;
}

// Linear elasticity: u_x = sigma/E x, u_y = -nu sigma/E y, u_z alike; the reaction balances the load.
TEST(UniaxialTest, LinearElastic) {
  const double E = 1e4, nu = 0.3, traction = 800;
  const Scene scene = PulledBar(LinearElastic(std::array{E, nu}), traction);
  const RunResult run = RunScene(scene);
  ASSERT_EQ(run.outcome.kind, Outcome::Kind::kSucceeded);
  const double strain = traction / E;
  for (std::size_t n = 0; n < scene.bodies[0].tet().mesh.nodes.size(); ++n) {
    const Vec3& X = scene.bodies[0].tet().mesh.nodes[n];
    const Vec3 exact(strain * X[0], -nu * strain * X[1], -nu * strain * X[2]);
    EXPECT_LT((run.frames.back().bodies[0].positions[n] - X - exact).norm(), 1e-7 * strain * 0.04);
  }
  EXPECT_NEAR(run.Last("box/reaction/x0/x"), -traction * 4e-4, 1e-6 * traction * 4e-4);
}

// Compressible neo-Hookean: P11 = traction and P22 = 0 with
//   P11 = mu (l - 1/l) + lambda ln(l t^2) / l,   P22 = mu (t - 1/t) + lambda ln(l t^2) / t.
TEST(UniaxialTest, NeoHookean) {
  const double E = 1e4, nu = 0.3, traction = 6000;
  const double mu = E / (2 * (1 + nu)), lambda = E * nu / ((1 + nu) * (1 - 2 * nu));
  double l = 1.2, t = 0.95;  // Newton
  for (int i = 0; i < 50; ++i) {
    const double log_J = std::log(l * t * t);
    const double r1 = mu * (l - 1 / l) + lambda * log_J / l - traction;
    const double r2 = mu * (t - 1 / t) + lambda * log_J / t;
    const double a = mu * (1 + 1 / (l * l)) + lambda * (1 - log_J) / (l * l), b = 2 * lambda / (l * t);
    const double c = lambda / (l * t), d = mu * (1 + 1 / (t * t)) + lambda * (2 - log_J) / (t * t);
    const double determinant = a * d - b * c;
    l -= (d * r1 - b * r2) / determinant;
    t -= (a * r2 - c * r1) / determinant;
  }
  const Scene scene = PulledBar(NeoHookean(std::array{E, nu}), traction);
  const RunResult run = RunScene(scene);
  ASSERT_EQ(run.outcome.kind, Outcome::Kind::kSucceeded);
  EXPECT_GT(l, 1.3);
  for (std::size_t n = 0; n < scene.bodies[0].tet().mesh.nodes.size(); ++n) {
    const Vec3& X = scene.bodies[0].tet().mesh.nodes[n];
    EXPECT_LT((run.frames.back().bodies[0].positions[n] - Vec3(l * X[0], t * X[1], t * X[2])).norm(), 1e-7 * 0.04);
  }
  EXPECT_NEAR(run.Last("box/volume_ratio"), l * t * t, 1e-7);
}

// A hanging body at rest: its support carries its weight.
TEST(WeightTest, ReactionBalancesIt) {
  for (const Stepping stepping : {Stepping::kExplicit, Stepping::kMixed}) {
    Body body = BoxBody(Vec3(0.02, 0.02, 0.04), {2, 2, 4}, NeoHookean(std::array{1e4, 0.3}));
    body.constraints = {Fix(kZ1)};
    body.damping = {.mass_proportional = 60, .viscosity = 2};
    Scene scene = OneBody(body);
    scene.gravity = {Vec3(0, 0, -9.81), Curve{{0, 0.05}, {0, 1}, Curve::Interpolation::kSmooth}};
    scene.tet.stepping = stepping;
    scene.output.settle_speed = 1e-9;
    scene.output.frame_interval = 0.02;
    scene.duration = 2;
    const RunResult run = RunScene(scene);
    ASSERT_EQ(run.outcome.kind, Outcome::Kind::kSucceeded);
    const double weight = 1060 * 0.02 * 0.02 * 0.04 * 9.81;
    EXPECT_NEAR(run.Last("box/reaction/z1/z"), weight, 1e-6 * weight);
    EXPECT_NEAR(run.Last("box/reaction/z1/x"), 0, 1e-6 * weight);
    if (stepping == Stepping::kMixed) {
      EXPECT_GT(run.At(1, "solver/iterations"), 0);
    }
  }
}

}  // namespace
}  // namespace fascicle
