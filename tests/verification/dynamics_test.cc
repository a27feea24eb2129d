// Bodies in motion, against conservation laws and prescribed paths.
#include <gtest/gtest.h>

#include <cmath>

#include "core/tet/diagnostics.h"
#include "tests/support/tet_scenes.h"
#include "tests/support/tet_stepper.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;

// The paper's torus, undamped, vibrating after it was squashed: its energy stays within 1 % over more than 1,000 steps.
class TorusEnergy : public ::testing::TestWithParam<int> {};

TEST_P(TorusEnergy, DriftStaysBelowOnePercent) {
  const std::vector<Material> laws = {LinearElastic(std::array{1e4, 0.3}), CorotatedLinear(std::array{1e4, 0.3})};
  const Scene scene = OneBody(MakeBody(
      "torus", MakeTorus({.major_radius = 0.05, .minor_radius = 0.015, .divisions_around = 16, .divisions_across = 4}),
      laws[GetParam()]));
  const TetModel model(scene);
  ThreadTeam team(1);
  TetStepper solver(model, team);
  TetState state = solver.InitialState();
  for (std::size_t n = 0; n < model.nodes(); ++n) {
    const Vec3& X = model.rest_positions()[n];
    state.velocities[n] = 4 * Vec3(X[0], -X[1], 0);  // to an ellipse and back
  }
  const double start = KineticEnergy(model, state.velocities, team);
  double largest_elastic = 0, drift = 0;
  int swings = 0;
  double before = 0;
  for (int step = 0; step < 5000; ++step) {
    ASSERT_EQ(solver.Advance(state, 100).problem, StepProblem::kNone);
    if (step % 10 != 0) continue;
    const double elastic = ElasticEnergy(model, 0, std::array{0.0}, state.positions, team);
    const double energy = elastic + KineticEnergy(model, state.velocities, team);
    drift = std::max(drift, std::abs(energy / start - 1));
    largest_elastic = std::max(largest_elastic, elastic);
    if ((elastic > start / 2) != (before > start / 2)) ++swings;
    before = elastic;
  }
  EXPECT_LT(drift, 0.01);
  EXPECT_GT(largest_elastic, 0.5 * start);  // it did oscillate
  EXPECT_GT(swings, 10);
}

INSTANTIATE_TEST_SUITE_P(Laws, TorusEnergy, ::testing::Values(0, 1));

// Every node has a prescribed rotation: its position and velocity are those of the curve, without stress.
TEST(PrescribedMotionTest, RigidRotation) {
  Body body = BoxBody(Vec3(0.03, 0.02, 0.02), {3, 2, 2}, NeoHookean(std::array{1e4, 0.3}));
  Region all{"all", {}, {}, {}, {}};
  for (std::size_t n = 0; n < body.tet().mesh.nodes.size(); ++n) all.nodes.push_back(static_cast<std::int32_t>(n));
  body.regions.push_back(all);
  Constraint turn{6, {true, true, true}, {}};
  const Vec3 axis = Vec3(1, 2, 2).normalized(), point(0.01, 0, 0.02);
  turn.motion.rotation = Rotation{point, axis, Curve{{0, 1}, {0, 9}}};
  turn.motion.translation[1] = Curve{{0, 1}, {0, 0.5}};
  body.constraints = {turn};
  body.damping = {.stiffness_proportional = 1e-3, .viscosity = 3};
  Scene scene = OneBody(body);
  scene.tet.time_step = 1e-4;
  scene.duration = 0.5;
  scene.output.fields = {OutputField::kVelocity, OutputField::kVonMisesStress};
  const RunResult run = RunScene(scene);
  ASSERT_EQ(run.outcome.kind, Outcome::Kind::kSucceeded);
  for (const Frame& frame : run.frames) {
    const double t = frame.time;
    const Mat3 R = Eigen::AngleAxisd(9 * t, axis).toRotationMatrix();
    for (std::size_t n = 0; n < body.tet().mesh.nodes.size(); ++n) {
      const Vec3 arm = R * (body.tet().mesh.nodes[n] - point);
      EXPECT_LT((frame.bodies[0].positions[n] - (arm + point + Vec3(0, 0.5 * t, 0))).norm(), 1e-15);
      const double* v = &frame.bodies[0].fields[0].values[3 * n];
      EXPECT_LT((Vec3(v[0], v[1], v[2]) - (9 * axis.cross(arm) + Vec3(0, 0.5, 0))).norm(), 1e-13);
    }
    for (const double stress : frame.bodies[0].fields[1].values) EXPECT_LT(stress, 1e-8);  // of 1e4 Pa
  }
  // Over a step the path is a chord: with theta the rotation per step, the strain rate is theta^2 / (2 dt) across the
  // axis, which dissipates 5e-9 J of the kinetic energy of 6e-4 J here, and vanishes with the square of the step.
  EXPECT_LT(run.Last("energy/dissipated"), 1e-8);
  EXPECT_LT(std::abs(run.Last("energy/elastic")), 1e-15);
}

// One end is moved out and back smoothly: the probe on it follows the curve, and the work is returned.
TEST(PrescribedMotionTest, StretchedAndReleased) {
  Body body = BoxBody(Vec3(0.04, 0.02, 0.02), {4, 2, 2}, NeoHookean(std::array{1e4, 0.3}));
  Constraint pull = Fix(kX1);
  const Curve curve{{0, 0.2, 0.4}, {0, 0.01, 0}, Curve::Interpolation::kSmooth};
  pull.motion.translation[0] = curve;
  body.constraints = {Fix(kX0), pull};
  body.damping.mass_proportional = 20;
  Scene scene = OneBody(body);
  scene.duration = 0.6;
  scene.output.frame_interval = 0.05;
  scene.output.probes = {{"end", 0, 4}};
  const RunResult run = RunScene(scene);
  ASSERT_EQ(run.outcome.kind, Outcome::Kind::kSucceeded);
  for (std::size_t k = 0; k < run.frames.size(); ++k) {
    EXPECT_NEAR(run.At(k, "probe/end/x"), curve.At(run.frames[k].time), 1e-16);
    EXPECT_EQ(run.At(k, "probe/end/y"), 0);
  }
  // Pulled by 25 %: about E times strain times area, opposite at both ends.
  EXPECT_NEAR(run.At(4, "box/reaction/x1/x"), 0.25 * 1e4 * 4e-4, 0.25);
  EXPECT_NEAR(run.At(4, "box/reaction/x0/x"), -run.At(4, "box/reaction/x1/x"), 0.05);
  EXPECT_NEAR(run.Last("energy/elastic"), 0, 1e-3 * run.At(4, "energy/elastic"));
}

// The force that accelerates a body as a whole is its mass times the acceleration of its support.
TEST(PrescribedMotionTest, ReactionIsMassTimesAcceleration) {
  Body body = BoxBody(Vec3(0.02, 0.02, 0.02), {2, 2, 2}, NeoHookean(std::array{1e7, 0.3}));
  Constraint move = Fix(kX0);
  move.motion.translation[0] = Curve{{0, 1}, {0, 0.5}, Curve::Interpolation::kSmooth};
  body.constraints = {move};
  body.damping.stiffness_proportional = 1e-5;
  Scene scene = OneBody(body);
  scene.duration = 0.3;
  scene.output.frame_interval = 0.1;
  const RunResult run = RunScene(scene);
  ASSERT_EQ(run.outcome.kind, Outcome::Kind::kSucceeded);
  for (std::size_t k = 1; k < run.frames.size(); ++k) {
    const double acceleration = 0.5 * (6 - 12 * run.frames[k].time);
    const double mass = 1060 * 8e-6;
    // The stiff body vibrates a little after the sudden start.
    EXPECT_NEAR(run.At(k, "box/reaction/x0/x"), mass * acceleration, 0.02 * mass * 3) << run.frames[k].time;
  }
}

}  // namespace
}  // namespace fascicle
