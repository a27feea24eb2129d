// Error control of implicit steps: the estimate against the true error, the error of a whole run, and where steps are
// short.
#include <gtest/gtest.h>

#include "core/tet/step_error.h"
#include "tests/support/released_run.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;

constexpr double kPeriod = 0.086;  // of the cantilever, about [s]

// A cantilever that is released.
ReleasedRun Cantilever(Stepping stepping, double time_step, std::optional<double> step_error = {}) {
  Body bar = BoxBody(Vec3(0.04, 0.01, 0.01), {4, 1, 1}, NeoHookean(std::array{1e5, 0.3}));
  bar.constraints = {Fix(kX0)};
  bar.loads.push_back({kX1, Traction{Vec3(0, 0, -100)}, Ramp(1), {}});
  Scene scene = StaticScene(std::move(bar), ElementOrder::kQuadratic);
  scene.tet.step_error = step_error;
  return ReleasedRun(scene, stepping, time_step);
}

double Diagonal() { return Vec3(0.04, 0.01, 0.01).norm(); }

// Root mean square over the mass of a difference of positions, relative to the body.
double Difference(const TetModel& model, const NodalVector& a, const NodalVector& b) {
  double squares = 0, mass = 0;
  for (std::size_t n = 0; n < a.size(); ++n) {
    squares += model.mass()[n] * (a[n] - b[n]).squaredNorm();
    mass += model.mass()[n];
  }
  return std::sqrt(squares / mass) / Diagonal();
}

class StepErrorTest : public ::testing::TestWithParam<Stepping> {};

// The error of one step, against the same motion in steps of a sixty-fourth.
TEST_P(StepErrorTest, IsEstimated) {
  const double dt = kPeriod / 60;
  ReleasedRun run = Cantilever(GetParam(), dt, 0.1), exact = Cantilever(Stepping::kNewmark, dt / 64);
  ASSERT_TRUE(run.is_in_equilibrium && exact.is_in_equilibrium);
  double estimate = 0, truth = 0;
  for (int step = 0; step < 20; ++step) {
    // Both begin at the exact state, but for the history of BDF2.
    const TetState before = run.state;
    const StepReport report = run.solver.Advance(run.state, before.time + dt);
    ASSERT_EQ(report.problem, StepProblem::kNone);
    ASSERT_NEAR(run.state.time, before.time + dt, 1e-9);
    ASSERT_TRUE(exact.To(run.state.time));
    estimate += report.error;
    truth += Difference(run.model, run.state.positions, exact.state.positions);
    run.state.positions = exact.state.positions;
    run.state.velocities = exact.state.velocities;
    if (GetParam() == Stepping::kNewmark) {
      run.state.accelerations = exact.state.accelerations;
      run.state.force = exact.state.force;
    }
  }
  EXPECT_GT(estimate, 0.4 * truth);
  EXPECT_LT(estimate, 2.5 * truth);
}

// An error below the sum of those of the steps, and so many more steps for a hundredth as the order of the error says.
TEST_P(StepErrorTest, BoundsTheErrorOfARun) {
  ReleasedRun exact = Cantilever(Stepping::kNewmark, kPeriod / 2000);
  ASSERT_TRUE(exact.To(kPeriod / 2));
  double error_before = 0, steps_before = 0;
  for (const double allowed : {1e-4, 1e-6}) {
    ReleasedRun run = Cantilever(GetParam(), 1, allowed);
    ASSERT_TRUE(run.To(kPeriod / 2));
    const double error = Difference(run.model, run.state.positions, exact.state.positions);
    const auto steps = static_cast<double>(run.state.step);
    if (error_before > 0) {
      const double exponent = GetParam() == Stepping::kBackwardEuler ? 1.0 / 2 : 1.0 / 3;
      // The first step of BDF2 is one of backward Euler.
      EXPECT_NEAR(std::log(steps / steps_before) / std::log(100), exponent, 0.12);
      EXPECT_LT(error, error_before);
    }
    EXPECT_LT(error, steps * allowed);  // the sum of the errors of all steps
    error_before = error;
    steps_before = steps;
  }
}

INSTANTIATE_TEST_SUITE_P(Steppings, StepErrorTest,
                         ::testing::Values(Stepping::kNewmark, Stepping::kBdf2, Stepping::kBackwardEuler),
                         [](const auto& test) {
                           return std::string(test.param == Stepping::kNewmark ? "newmark"
                                              : test.param == Stepping::kBdf2  ? "bdf2"
                                                                               : "backward_euler");
                         });

// Steps are short from when a load acts, and long before.
TEST(StepErrorTest, ShortensStepsWhereALoadActs) {
  Body bar = BoxBody(Vec3(0.04, 0.01, 0.01), {4, 1, 1}, NeoHookean(std::array{1e5, 0.3}));
  bar.constraints = {Fix(kX0)};
  bar.loads.push_back({kX1, Traction{Vec3(0, 0, -100)}, {{0.1, 0.101}, {0, 1}, Curve::Interpolation::kLinear}, {}});
  Scene scene = StaticScene(std::move(bar), ElementOrder::kQuadratic);
  scene.tet.stepping = Stepping::kNewmark;
  scene.tet.step_error = 1e-5;
  scene.output.frame_interval = 0.1;
  SteppedRun run(scene);
  ASSERT_TRUE(run.To(0.1));
  EXPECT_EQ(run.state.step, 1);
  ASSERT_TRUE(run.To(0.2));
  EXPECT_GT(run.state.step, 20);
}

}  // namespace
}  // namespace fascicle
