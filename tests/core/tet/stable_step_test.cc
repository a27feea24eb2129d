#include "core/tet/stable_step.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "core/tet/diagnostics.h"
#include "tests/support/tet_scenes.h"
#include "tests/support/tet_stepper.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;

Scene TestScene(const Material& law, const Damping& damping = {}) {
  Body body = BoxBody(Vec3(0.03, 0.02, 0.02), {3, 2, 2}, law);
  body.constraints.push_back(Fix(kX0));
  body.damping = damping;
  body.activation = Curve::Constant(0.7);
  return OneBody(body);
}

// The largest eigenvalue of M^-1/2 A M^-1/2 over the free components, from the dense matrix.
template <class Apply>
double DenseLargestEigenvalue(const TetModel& model, const Apply& apply) {
  const auto size = static_cast<Eigen::Index>(3 * model.nodes());
  Eigen::MatrixXd A(size, size);
  NodalVector unit(model.nodes(), Vec3::Zero()), column;
  for (Eigen::Index k = 0; k < size; ++k) {
    unit[k / 3][k % 3] = 1;
    apply(unit, column);
    unit[k / 3][k % 3] = 0;
    for (Eigen::Index i = 0; i < size; ++i) {
      A(i, k) =
          column[i / 3][i % 3] * std::sqrt(model.inverse_mass()[i / 3][i % 3] * model.inverse_mass()[k / 3][k % 3]);
    }
  }
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(0.5 * (A + A.transpose())).eigenvalues()[size - 1];
}

double DenseOmegaSquared(const TetModel& model, const NodalVector& x, ThreadTeam& team) {
  TetStiffness stiffness;
  ForceWorkspace corners;
  const std::array<double, 1> activation = {0.7};
  stiffness.Set(model, activation, x, team, corners);
  return DenseLargestEigenvalue(
      model, [&](const NodalVector& p, NodalVector& q) { stiffness.Apply(model, p, team, corners, q); });
}

class StableStepTest : public ::testing::TestWithParam<int> {
 protected:
  Scene scene_ = TestScene(EveryLaw()[GetParam()]);
  TetModel model_{scene_};
  ThreadTeam team_{1};
};

// The estimate is conservative and close: Lanczos stops at a residual of 2 % of omega^2, 1 % of the step.
TEST_P(StableStepTest, IsTheInverseOfTheLargestFrequency) {
  const NodalVector x = Shaken(model_.rest_positions(), 5e-4, 3);
  const double exact = 2 / std::sqrt(DenseOmegaSquared(model_, x, team_));
  ForceWorkspace corners;
  StableStepWorkspace workspace;
  const std::array<double, 1> activation = {0.7};
  const double estimate = LargestStableStep(model_, activation, x, true, team_, corners, workspace);
  EXPECT_LE(estimate, exact * (1 + 1e-6));
  EXPECT_GE(estimate, exact * 0.98);
}

// Small vibrations stay bounded at 0.99 of the limit and grow without bound at 1.1 of it.
TEST_P(StableStepTest, SeparatesStableFromUnstable) {
  scene_.bodies[0].activation = Curve::Constant(0);  // rest is then an equilibrium
  const TetModel model(scene_);
  TetStepper solver(model, team_);
  const double limit = solver.StableStepAt(solver.InitialState());
  const auto growth = [&](double factor) {
    TetState state = solver.InitialState(), next;
    state.positions = Shaken(model.rest_positions(), 1e-9, 4);
    const Controls controls = ControlSource(scene_).At(0);
    PrescribePositions(model, controls, state.positions);
    ForceWorkspace corners;
    ElasticForce(model, controls.activations, state.positions, team_, corners, state.force);
    for (int i = 0; i < 600; ++i) {
      if (solver.Attempt(state, state.time + factor * limit, next).problem != StepProblem::kNone) return 1e9;
      std::swap(state, next);
    }
    return LargestDifference(state.positions, model.rest_positions()) / 1e-9;
  };
  // At 0.99 the highest mode, sampled twice per period, may appear 1 / sqrt(1 - 0.99^2) = 7 times as large.
  EXPECT_LT(growth(0.99), 30);
  EXPECT_GT(growth(1.1), 1e3);
}

INSTANTIATE_TEST_SUITE_P(Laws, StableStepTest, ::testing::Range(0, kLaws));

// With explicit damping: (omega dt)^2 + 2 rate dt = 4.
TEST(DampedStableStepTest, AgreesWithTheFormula) {
  const Scene scene = TestScene(NeoHookean(std::array{1e4, 0.3}), {.mass_proportional = 3, .viscosity = 20});
  const TetModel model(scene);
  ThreadTeam team(1);
  ForceWorkspace corners;
  StableStepWorkspace workspace;
  const NodalVector& X = model.rest_positions();
  const std::array<double, 1> activation = {0.7};
  const double omega_squared = DenseOmegaSquared(model, X, team);
  const double rate = DenseLargestEigenvalue(model, [&](const NodalVector& p, NodalVector& q) {
    ViscousForce(model, X, p, team, corners, q);
    for (Vec3& value : q) value = -value;
  });
  const double omega = std::sqrt(omega_squared), xi = rate / (2 * omega);
  EXPECT_GT(xi, 0.5);
  const double exact = 2 / omega * (std::sqrt(1 + xi * xi) - xi);
  const double estimate = LargestStableStep(model, activation, X, true, team, corners, workspace);
  EXPECT_LE(estimate, exact * (1 + 1e-6));
  EXPECT_GE(estimate, exact * 0.97);
  // Implicit damping does not reduce the step.
  EXPECT_GT(LargestStableStep(model, activation, X, false, team, corners, workspace), 0.98 * 2 / omega);
}

// A run with strong explicit damping at the automatic step loses energy and comes to rest.
TEST(DampedStableStepTest, IsStable) {
  Scene scene = TestScene(NeoHookean(std::array{1e4, 0.3}), {.viscosity = 20});
  scene.bodies[0].loads.push_back({kX1, NodalForce{Vec3(0, 0, -0.01)}, Curve::Constant(1), {}});
  scene.duration = 1;
  const RunResult run = RunScene(scene);
  ASSERT_EQ(run.outcome.kind, Outcome::Kind::kSucceeded);
  EXPECT_LT(run.Last("energy/kinetic"), 1e-3 * run.Last("energy/elastic"));
  // The work done by the load is stored or dissipated; first order only, because the viscous force lags half a step.
  EXPECT_NEAR(run.Last("energy/elastic") + run.Last("energy/kinetic") + run.Last("energy/dissipated"),
              run.Last("energy/external_work"), 0.02 * run.Last("energy/external_work"));
}

}  // namespace
}  // namespace fascicle
