// Work against energy. Quasi-static: elastic energy = work of loads, gravity, supports and activation, to 1e-6.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/static_run.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;

Curve SmoothRamp(double value) { return {{0, 1}, {0, value}, Curve::Interpolation::kSmooth}; }

Material MuscleLaw() { return Muscle(std::array{5e2, 5e2, 1e5, 3e4, 1.2, 0.05, 6.6, 1.4}); }

// Checks the balance in every frame; returns the run.
RunResult CheckBalance(const char* what, Scene scene) {
  scene.output.frame_interval = 0.1;
  scene.tet.newton_tolerance = 1e-10;
  const RunResult run = RunScene(scene);
  EXPECT_EQ(run.outcome.kind, Outcome::Kind::kSucceeded) << run.outcome.failure.message;
  const double start = run.At(0, "energy/elastic");
  double error = 0, largest = 0;
  for (std::size_t k = 0; k < run.frames.size(); ++k) {
    const double gained = run.At(k, "energy/elastic") - start;
    const double external = run.At(k, "energy/external_work"), activation = run.At(k, "energy/activation_work");
    error = std::max(error, std::abs(gained - external - activation));
    largest = std::max({largest, std::abs(gained), std::abs(external), std::abs(activation)});
  }
  std::printf("%s: elastic %.6g J, external %.6g J, activation %.6g J; largest error %.1e of the largest\n", what,
              run.Last("energy/elastic"), run.Last("energy/external_work"), run.Last("energy/activation_work"),
              error / largest);
  EXPECT_GT(largest, 1e-6);
  EXPECT_LT(error, 1e-6 * largest);
  return run;
}

// The work of a support that moves along x is the integral of its reaction, here by the trapezoidal rule over frames.
double IntegralOfReaction(const RunResult& run, double full) {
  double work = 0;
  for (std::size_t k = 1; k < run.frames.size(); ++k) {
    const auto position = [&](std::size_t frame) {
      const double s = run.frames[frame].time;
      return full * s * s * (3 - 2 * s);
    };
    work +=
        0.5 * (run.At(k - 1, "box/reaction/x1/x") + run.At(k, "box/reaction/x1/x")) * (position(k) - position(k - 1));
  }
  return work;
}

Scene Pulled(Material material, double by, double activation) {
  Body body = BoxBody(Vec3(0.02, 0.005, 0.005), {4, 1, 1}, std::move(material));
  Constraint pull = Fix(kX1);
  pull.motion.translation[0] = SmoothRamp(by);
  body.constraints = {Fix(kX0), pull};
  body.activation = SmoothRamp(activation);
  return StaticScene(std::move(body), ElementOrder::kQuadratic);
}

TEST(WorkTest, OfASupportThatPulls) {
  const RunResult run =
      CheckBalance("pulled tendon", Pulled(Tendon(std::array{5e4, 5e4, 2e7, 2.7e6, 46.4, 1.03}), 4e-4, 0));
  EXPECT_GT(run.Last("energy/external_work"), 1e-5);
  EXPECT_EQ(run.Last("energy/activation_work"), 0);
  EXPECT_EQ(run.Last("energy/load_work"), 0);
  EXPECT_NEAR(run.Last("energy/external_work"), IntegralOfReaction(run, 4e-4), 0.01 * run.Last("energy/external_work"));
}

TEST(WorkTest, OfActivationAtConstantLength) {
  const RunResult run = CheckBalance("isometric muscle", Pulled(MuscleLaw(), 0, 1));
  EXPECT_EQ(run.Last("energy/external_work"), 0);
  EXPECT_GT(std::abs(run.Last("energy/activation_work")), 1e-6);
}

TEST(WorkTest, OfActivationAndASupport) {
  const RunResult run = CheckBalance("lengthened active muscle", Pulled(MuscleLaw(), 2e-3, 1));
  EXPECT_NEAR(run.Last("energy/external_work"), IntegralOfReaction(run, 2e-3), 0.02 * run.Last("energy/external_work"));
}

// A load, gravity and a support that rotates, with large deformation.
TEST(WorkTest, OfALoadGravityAndARotation) {
  Body body = BoxBody(Vec3(0.06, 0.01, 0.01), {6, 1, 1}, NeoHookean(std::array{1e5, 0.45}));
  Constraint turn = Fix(kX0);
  turn.motion.rotation = Rotation{Vec3(0, 0.005, 0.005), Vec3(1, 0, 1).normalized(), SmoothRamp(0.5)};
  body.constraints = {turn};
  body.loads.push_back({kX1, Traction{Vec3(0, 0, -100)}, SmoothRamp(1), {}});
  Scene scene = StaticScene(std::move(body), ElementOrder::kQuadratic);
  scene.gravity = {Vec3(0, 0, -9.81), SmoothRamp(1)};
  const RunResult run = CheckBalance("loaded beam", scene);
  EXPECT_GT(run.Last("energy/external_work"), 1e-5);
}

TEST(WorkTest, OfAPressureAndSprings) {
  Body body = BoxBody(Vec3(0.02, 0.005, 0.005), {4, 1, 1}, NeoHookean(std::array{1e4, 0.3}));
  Load springs, pressure;
  springs.region = kX0;
  springs.kind = Springs{Vec3(20, 20, 20)};
  pressure.region = kZ1;
  pressure.kind = Pressure{120};
  pressure.scale = SmoothRamp(1);
  body.constraints = {Fix(kX1)};
  body.loads = {springs, pressure};
  const RunResult run =
      CheckBalance("block on springs under pressure", StaticScene(std::move(body), ElementOrder::kQuadratic));
  EXPECT_NE(run.Last("energy/load_work"), 0);
}

// With inertia the balance holds to the order of the stepping, also where a support moves and damping acts on it.
TEST(WorkTest, OfASupportInDynamics) {
  Body body = BoxBody(Vec3(0.03, 0.01, 0.01), {6, 2, 2}, NeoHookean(std::array{1e4, 0.3}));
  Constraint pull = Fix(kX1);
  pull.motion.translation[0] = Curve{{0, 0.05}, {0, 0.006}, Curve::Interpolation::kSmooth};
  body.constraints = {Fix(kX0), pull};
  body.damping.mass_proportional = 20;
  body.damping.viscosity = 2;
  Scene scene = OneBody(std::move(body));
  scene.duration = 0.1;
  scene.output.frame_interval = 0.01;
  for (const Stepping stepping : {Stepping::kExplicit, Stepping::kMixed}) {
    scene.tet.stepping = stepping;
    const RunResult run = RunScene(scene);
    ASSERT_EQ(run.outcome.kind, Outcome::Kind::kSucceeded);
    for (std::size_t k = 0; k < run.frames.size(); ++k) {
      const double sum = run.At(k, "energy/elastic") + run.At(k, "energy/kinetic") + run.At(k, "energy/dissipated");
      EXPECT_NEAR(sum, run.At(k, "energy/external_work"), 5e-3 * run.Last("energy/external_work")) << k;
    }
    EXPECT_GT(run.Last("energy/external_work"), 1e-5);
  }
}

// A support that starts to move does not act on a body at rest; damping has no part in quasi-static stepping.
TEST(WorkTest, ReactionsOfARestingBodyAreZero) {
  Scene scene = Pulled(NeoHookean(std::array{1e4, 0.3}), 2e-3, 0);
  scene.bodies[0].constraints[1].motion.translation[0] = Ramp(2e-3);
  scene.bodies[0].damping.viscosity = 1e3;
  scene.bodies[0].damping.mass_proportional = 100;
  const RunResult run = RunScene(scene);
  for (const char* axis : {"x", "y", "z"}) {
    EXPECT_NEAR(run.At(0, std::string("box/reaction/x1/") + axis), 0, 1e-12);
    EXPECT_NEAR(run.At(0, std::string("box/reaction/x0/") + axis), 0, 1e-12);
  }
  EXPECT_GT(run.Last("box/reaction/x1/x"), 1e-3);
}

}  // namespace
}  // namespace fascicle
