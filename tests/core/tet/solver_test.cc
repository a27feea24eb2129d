// The steppings against closed forms, and the solver's behaviour if a step fails.
#include "core/tet/solver.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "core/tet/diagnostics.h"
#include "tests/support/stage_watch.h"
#include "tests/support/tet_scenes.h"
#include "tests/support/tet_stepper.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;

// One eigenmode of a small clamped box, which vibrates as a single mass on a spring.
class Mode {
 public:
  explicit Mode(const Damping& damping, Stepping stepping) {
    Body body = BoxBody(Vec3(0.04, 0.02, 0.02), {2, 1, 1}, LinearElastic(std::array{1e4, 0.3}));
    body.constraints.push_back(Fix(kX0));
    body.damping = damping;
    scene_ = OneBody(body);
    scene_.tet.stepping = stepping;
    scene_.tet.solver_tolerance = 1e-13;
    model_.emplace(scene_);
    solver_.emplace(*model_, team_);
    FindMode();
  }

  double omega() const { return omega_; }

  // Amplitude after `time` in `steps` equal steps, from amplitude 1 at rest; the motion is small enough (1e-7 of the
  // body) for the viscous force to be linear.
  double AmplitudeAt(double time, int steps) {
    TetState state = solver_->InitialState(), next;
    for (std::size_t n = 0; n < model_->nodes(); ++n) state.positions[n] += kScale * shape_[n];
    ForceWorkspace corners;
    const std::array<double, 1> activation = {0};
    ElasticForce(*model_, activation, state.positions, team_, corners, state.force);
    for (int i = 1; i <= steps; ++i) {
      const StepReport report = solver_->Attempt(state, time * i / steps, next);
      EXPECT_EQ(report.problem, StepProblem::kNone);
      std::swap(state, next);
    }
    double amplitude = 0;  // M-weighted projection on the mode
    for (std::size_t n = 0; n < model_->nodes(); ++n) {
      amplitude += model_->mass()[n] * shape_[n].dot(state.positions[n] - model_->rest_positions()[n]);
    }
    return amplitude / kScale;
  }

 private:
  static constexpr double kScale = 1e-10;

  void FindMode() {
    const auto size = static_cast<Eigen::Index>(3 * model_->nodes());
    TetStiffness stiffness;
    ForceWorkspace corners;
    const std::array<double, 1> activation = {0};
    Eigen::MatrixXd A(size, size);
    NodalVector unit(model_->nodes(), Vec3::Zero()), ahead, behind;
    // Columns of K by differences of the (linear) force, exact except for round-off.
    for (Eigen::Index k = 0; k < size; ++k) {
      NodalVector x = model_->rest_positions();
      x[k / 3][k % 3] += 1e-3;
      ElasticForce(*model_, activation, x, team_, corners, ahead);
      x[k / 3][k % 3] -= 2e-3;
      ElasticForce(*model_, activation, x, team_, corners, behind);
      for (Eigen::Index i = 0; i < size; ++i) {
        A(i, k) = (behind[i / 3][i % 3] - ahead[i / 3][i % 3]) / 2e-3 *
                  std::sqrt(model_->inverse_mass()[i / 3][i % 3] * model_->inverse_mass()[k / 3][k % 3]);
      }
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(0.5 * (A + A.transpose()));
    Eigen::Index mode = 0;  // the lowest except for those of fixed components
    while (eigen.eigenvalues()[mode] < 1e-8 * eigen.eigenvalues()[size - 1]) ++mode;
    omega_ = std::sqrt(eigen.eigenvalues()[mode]);
    for (std::size_t n = 0; n < model_->nodes(); ++n) {
      Vec3 value;
      for (int c = 0; c < 3; ++c) {
        const auto i = static_cast<Eigen::Index>(3 * n) + c;
        value[c] = eigen.eigenvectors()(i, mode) * std::sqrt(model_->inverse_mass()[n][c]);
      }
      shape_.push_back(value);
    }
  }

  Scene scene_;
  std::optional<TetModel> model_;
  ThreadTeam team_{1};
  std::optional<TetStepper> solver_;
  double omega_ = 0;
  NodalVector shape_;
};

// q'' + 2 d q' + omega^2 q = 0, q(0) = 1, q'(0) = 0.
double DampedOscillation(double omega, double d, double t) {
  const double w = std::sqrt(omega * omega - d * d);
  return std::exp(-d * t) * (std::cos(w * t) + d / w * std::sin(w * t));
}

// Order from the errors with n and 2n steps.
double OrderOf(Mode& mode, double d) {
  const double time = 1.7 * 2 * 3.14159265358979 / mode.omega();
  const double exact = DampedOscillation(mode.omega(), d, time);
  const double coarse = std::abs(mode.AmplitudeAt(time, 400) - exact);
  const double fine = std::abs(mode.AmplitudeAt(time, 800) - exact);
  EXPECT_LT(coarse, 0.05);
  return std::log2(coarse / fine);
}

// The mode's frequency must be known before its damping is chosen.
double OmegaOfMode() { return Mode({}, Stepping::kExplicit).omega(); }

TEST(ConvergenceTest, ExplicitIsSecondOrder) {
  Mode mode({}, Stepping::kExplicit);
  EXPECT_NEAR(OrderOf(mode, 0), 2, 0.05);
}

TEST(ConvergenceTest, ExplicitWithMassDampingIsSecondOrder) {
  const double a = 0.2 * OmegaOfMode();
  Mode mode({.mass_proportional = a}, Stepping::kExplicit);
  EXPECT_NEAR(OrderOf(mode, a / 2), 2, 0.05);
}

// The viscous force uses the velocity of half a step earlier.
TEST(ConvergenceTest, ExplicitWithViscousDampingIsFirstOrder) {
  const double omega = OmegaOfMode(), b = 0.05 / omega;
  Mode mode({.stiffness_proportional = b}, Stepping::kExplicit);
  EXPECT_NEAR(OrderOf(mode, b * omega * omega / 2), 1, 0.1);
}

TEST(ConvergenceTest, MixedWithoutDampingIsSecondOrder) {
  Mode mode({}, Stepping::kMixed);
  EXPECT_NEAR(OrderOf(mode, 0), 2, 0.05);
}

// Damping by two half steps of backward Euler.
TEST(ConvergenceTest, MixedWithDampingIsFirstOrder) {
  const double omega = OmegaOfMode(), b = 0.1 / omega, a = 0.1 * omega;
  Mode mode({.mass_proportional = a, .stiffness_proportional = b}, Stepping::kMixed);
  EXPECT_NEAR(OrderOf(mode, a / 2 + b * omega * omega / 2), 1, 0.1);
}

// Large motion, compared with a sixteenth of the step: halving divides the error by (4 - 4/256) / (1 - 4/256).
class NonlinearConvergence : public ::testing::TestWithParam<Stepping> {};

TEST_P(NonlinearConvergence, Order) {
  Body body = BoxBody(Vec3(0.04, 0.02, 0.02), {2, 1, 1}, NeoHookean(std::array{1e4, 0.3}));
  body.constraints.push_back(Fix(kX0));
  if (GetParam() == Stepping::kMixed) body.damping.viscosity = 20;
  Scene scene = OneBody(body);
  scene.tet.stepping = GetParam();
  scene.tet.solver_tolerance = 1e-13;
  const TetModel model(scene);
  ThreadTeam team(1);
  TetStepper solver(model, team);
  const auto solve = [&](int steps) {
    TetState state = solver.InitialState(), next;
    for (std::size_t n = 0; n < model.nodes(); ++n) {
      state.velocities[n] = 20 * model.rest_positions()[n][0] * Vec3(0, 1, 0.5);
    }
    for (int i = 1; i <= steps; ++i) {
      EXPECT_EQ(solver.Attempt(state, 0.02 * i / steps, next).problem, StepProblem::kNone);
      std::swap(state, next);
    }
    return state.positions;
  };
  const NodalVector reference = solve(6400);
  const double coarse = LargestDifference(solve(200), reference), fine = LargestDifference(solve(400), reference);
  EXPECT_GT(LargestDifference(reference, model.rest_positions()), 2e-3);
  const double order = GetParam() == Stepping::kExplicit ? 2 : 1;
  EXPECT_NEAR(std::log2(coarse / fine), order, 0.15);
}

INSTANTIATE_TEST_SUITE_P(Steppings, NonlinearConvergence, ::testing::Values(Stepping::kExplicit, Stepping::kMixed));

// A step that is stopped within a linear solve leaves the state unchanged, and the step made later has the bits of one
// that was never disturbed.
TEST(StopTest, EndsALongStepAndLeavesNoTrace) {
  Scene scene = OneBody(BoxBody(Vec3(0.02, 0.02, 0.06), {8, 8, 24}, NeoHookean(std::array{2e4, 0.4})));
  scene.tet.stepping = Stepping::kQuasiStatic;
  scene.tet.time_step = 0.001;
  scene.bodies[0].constraints = {Fix(kZ0)};
  scene.gravity.acceleration = Vec3(9.81, 0, 0);
  scene.gravity.scale = Curve{{0, 1}, {0, 1}};
  const TetModel model(scene);
  ThreadTeam team(1);
  Profile profile;
  TetStepper disturbed(model, team, &profile), undisturbed(model, team);
  TetState state = disturbed.InitialState(), before = state;
  StopAtStage stop(profile, "Newton/iterative solve");
  team.HeedStop(stop.token());
  const auto step_until_stopped = [&] {
    while (state.time < 1) {
      before = state;
      if (disturbed.Advance(state, 1).problem != StepProblem::kNone) return;
    }
  };
  EXPECT_THROW(step_until_stopped(), Stopped);
  team.HeedStop({});
  EXPECT_LE(CallsOf(profile, "Newton/iterative solve"), stop.CallsAtStop());
  EXPECT_EQ(state.time, before.time);
  EXPECT_EQ(disturbed.Advance(state, 1).problem, StepProblem::kNone);
  EXPECT_EQ(undisturbed.Advance(before, 1).problem, StepProblem::kNone);
  EXPECT_EQ(state.positions, before.positions);
}

// x = g t^2 / 2 and v = g t at every step, for both steppings: quadratic motion is integrated exactly.
TEST(FreeFallTest, IsExact) {
  for (const Stepping stepping : {Stepping::kExplicit, Stepping::kMixed}) {
    Body body = BoxBody(Vec3(0.03, 0.02, 0.02), {3, 2, 2}, NeoHookean(std::array{1e4, 0.3}));
    Scene scene = OneBody(body);
    scene.tet.stepping = stepping;
    scene.gravity.acceleration = Vec3(0, 1, -9.81);
    const TetModel model(scene);
    ThreadTeam team(1);
    TetStepper solver(model, team);
    TetState state = solver.InitialState();
    while (state.time < 0.2) ASSERT_EQ(solver.Advance(state, 0.2).problem, StepProblem::kNone);
    EXPECT_EQ(state.time, 0.2);
    const Vec3 shift = 0.5 * 0.04 * scene.gravity.acceleration, velocity = 0.2 * scene.gravity.acceleration;
    for (std::size_t n = 0; n < model.nodes(); ++n) {
      EXPECT_LT((state.positions[n] - model.rest_positions()[n] - shift).norm(), 1e-12);
      EXPECT_LT((state.velocities[n] - velocity).norm(), 1e-10);
    }
    // Work of gravity = kinetic energy.
    EXPECT_NEAR(state.external_work, KineticEnergy(model, state.velocities, team), 1e-12 * state.external_work);
  }
}

// Without supports and gravity, momentum and angular momentum are conserved to round-off, while the body deforms
// strongly with damping.
TEST(MomentumTest, IsConserved) {
  for (const Stepping stepping : {Stepping::kExplicit, Stepping::kMixed}) {
    Body body = BoxBody(Vec3(0.03, 0.02, 0.02), {3, 2, 2}, NeoHookean(std::array{1e4, 0.3}));
    body.damping.viscosity = 0.5;
    Scene scene = OneBody(body);
    scene.tet.stepping = stepping;
    scene.tet.solver_tolerance = 1e-14;
    const TetModel model(scene);
    ThreadTeam team(1);
    TetStepper solver(model, team);
    TetState state = solver.InitialState();
    const NodalVector noise = RandomVectors(model.nodes(), 1);
    for (std::size_t n = 0; n < model.nodes(); ++n) {
      state.velocities[n] = Vec3(0.2, -0.1, 0.3) + Vec3(5, 10, -20).cross(model.rest_positions()[n]) + 0.3 * noise[n];
    }
    const auto momenta = [&] {
      Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();
      for (std::size_t n = 0; n < model.nodes(); ++n) {
        const Vec3 p = model.mass()[n] * state.velocities[n];
        linear += p;
        angular += state.positions[n].cross(p);
      }
      return std::pair{linear, angular};
    };
    const auto [linear, angular] = momenta();
    for (int i = 0; i < 2000; ++i) ASSERT_EQ(solver.Advance(state, 100).problem, StepProblem::kNone);
    EXPECT_GT(LargestDifference(state.positions, model.rest_positions()), 0.01);
    const auto [linear_after, angular_after] = momenta();
    // The implicit solves leave a residual of 1e-14 of their right-hand side in each of 2,000 steps.
    const double allowed = stepping == Stepping::kExplicit ? 1e-12 : 1e-10;
    EXPECT_LT((linear_after - linear).norm(), allowed * linear.norm());
    EXPECT_LT((angular_after - angular).norm(), allowed * angular.norm());
  }
}

// A user's step is used unchanged while it is stable, and halved otherwise: no energy is created.
TEST(FixedStepTest, IsHalvedUntilItIsStable) {
  Body body = BoxBody(Vec3(0.03, 0.02, 0.02), {3, 2, 2}, NeoHookean(std::array{1e4, 0.3}));
  body.constraints.push_back(Fix(kX0));
  body.loads.push_back({kX1, NodalForce{Vec3(0, 0, -0.02)}, Curve::Constant(1), {}});
  Scene scene = OneBody(body);
  const TetModel automatic(scene);
  ThreadTeam team(1);
  const double limit = TetStepper(automatic, team).StableStepAt(TetStepper(automatic, team).InitialState());
  for (const double factor : {0.5, 3.0}) {
    scene.tet.time_step = factor * limit;
    const TetModel model(scene);
    TetStepper solver(model, team);
    TetState state = solver.InitialState();
    double largest_work = 0, largest_error = 0;
    while (state.time < 0.2) {
      ASSERT_EQ(solver.Advance(state, 100).problem, StepProblem::kNone);
      // Steps divide the time to `end` evenly, so they are shorter by at most one part in their number.
      EXPECT_NEAR(state.time_step, (factor < 1 ? factor : factor / 4) * limit, 1e-4 * limit);
      const double energy = ElasticEnergy(model, 0, std::array{0.0}, state.positions, team) +
                            KineticEnergy(model, state.velocities, team);
      largest_work = std::max(largest_work, std::abs(state.external_work));
      largest_error = std::max(largest_error, std::abs(energy - state.external_work));
    }
    // The sudden load excites high modes, whose energy the scheme conserves only on average.
    EXPECT_LT(largest_error, 0.1 * largest_work);
  }
}

// Nodes thrown at each other near the speed of sound would crush elements in one stable step: the step is divided, and
// no energy is created. With damping the motion decays and the step regains its length.
TEST(StepCuttingTest, RecoversFromAViolentStart) {
  for (const double damping : {0.0, 100.0}) {
    Body body = BoxBody(Vec3(0.03, 0.02, 0.02), {3, 2, 2}, NeoHookean(std::array{1e4, 0.3}));
    body.damping.mass_proportional = damping;
    const Scene scene = OneBody(body);
    const TetModel model(scene);
    ThreadTeam team(1);
    TetStepper solver(model, team);
    TetState state = solver.InitialState();
    state.velocities = RandomVectors(model.nodes(), 5);
    for (Vec3& v : state.velocities) v *= 3;
    const double start = KineticEnergy(model, state.velocities, team);
    int most_cuts = 0;
    for (int i = 0; i < 2000; ++i) {
      ASSERT_EQ(solver.Advance(state, 100).problem, StepProblem::kNone) << "step " << i;
      most_cuts = std::max(most_cuts, state.cuts);
      ASSERT_GT(VolumeRatiosOf(model, 0, state.positions).smallest, 0);
    }
    EXPECT_GT(most_cuts, 0);
    const double energy =
        ElasticEnergy(model, 0, std::array{0.0}, state.positions, team) + KineticEnergy(model, state.velocities, team);
    EXPECT_NEAR(energy + state.dissipated, start, 0.02 * start);
    if (damping > 0) {
      EXPECT_EQ(state.cuts, 0);
      EXPECT_NEAR(state.time_step, 0.9 * solver.StableStepAt(state), 0.01 * state.time_step);
    }
  }
}

}  // namespace
}  // namespace fascicle
