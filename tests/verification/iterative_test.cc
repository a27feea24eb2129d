// Iterative linear solvers: the same results as with factorization, the same bits for any number of threads and after a
// restart, and a time that grows moderately with the size.
#include <gtest/gtest.h>

#include "tests/support/reference_problems.h"
#include "tests/support/static_run.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;

Scene MuscleScene(ElementOrder element, LinearSolver solver, Stepping stepping = Stepping::kQuasiStatic) {
  Scene scene = StaticScene(ReferenceMuscle(3, Ramp(1), CellsOf(element)), element);
  scene.tet.linear_solver = solver;
  scene.tet.stepping = stepping;
  return scene;
}

double LargestDistance(const NodalVector& a, const NodalVector& b) {
  double largest = 0;
  for (std::size_t n = 0; n < a.size(); ++n) largest = std::max(largest, (a[n] - b[n]).norm());
  return largest;
}

class IterativeTest : public ::testing::TestWithParam<ElementOrder> {};

TEST_P(IterativeTest, ArrivesWhereFactorizationsDo) {
  SteppedRun direct(MuscleScene(GetParam(), LinearSolver::kDirect));
  SteppedRun iterative(MuscleScene(GetParam(), LinearSolver::kIterative));
  ASSERT_TRUE(direct.To(1));
  ASSERT_TRUE(iterative.To(1));
  // Both within the tolerance of Newton's method, 1e-8 of the force; the muscle is 100 mm long.
  EXPECT_LE(LargestDistance(direct.state.positions, iterative.state.positions), 1e-8);
  EXPECT_NEAR(direct.Reaction(1)[2], iterative.Reaction(1)[2], 1e-6 * direct.Reaction(1)[2]);
}

TEST_P(IterativeTest, TheReportSaysHow) {
  SteppedRun direct(MuscleScene(GetParam(), LinearSolver::kDirect));
  SteppedRun iterative(MuscleScene(GetParam(), LinearSolver::kIterative));
  const LinearSolves by_factorization = direct.solver.Advance(direct.state, 0.3).solves;
  EXPECT_GT(by_factorization.direct, 0);
  EXPECT_EQ(by_factorization.iterative, 0);
  const LinearSolves by_iteration = iterative.solver.Advance(iterative.state, 0.3).solves;
  EXPECT_GT(by_iteration.iterative, 0);
  EXPECT_EQ(by_iteration.direct, 0);
  EXPECT_EQ(by_iteration.not_converged, 0);
  EXPECT_GT(by_iteration.iterations, by_iteration.iterative);
}

TEST_P(IterativeTest, SameBitsForAnyThreadsAndAfterARestart) {
  const Scene scene = MuscleScene(GetParam(), LinearSolver::kIterative);
  const TetModel model(scene);
  const auto run = [&](int threads, bool restart) {
    ThreadTeam team(threads);
    auto solver = std::make_unique<TetStepper>(model, team);
    TetState state = solver->InitialState();
    for (const double end : {0.3, 0.6, 1.0}) {
      if (restart) solver = std::make_unique<TetStepper>(model, team);
      while (state.time < end) {
        if (solver->Advance(state, end).problem != StepProblem::kNone) {
          ADD_FAILURE() << "stopped at " << state.time;
          return state.positions;
        }
      }
    }
    return state.positions;
  };
  const NodalVector reference = run(1, false);
  EXPECT_EQ(LargestDistance(run(3, false), reference), 0);
  EXPECT_EQ(LargestDistance(run(1, true), reference), 0);
}

TEST_P(IterativeTest, DynamicStepsToo) {
  SteppedRun direct(MuscleScene(GetParam(), LinearSolver::kDirect, Stepping::kBackwardEuler));
  SteppedRun iterative(MuscleScene(GetParam(), LinearSolver::kIterative, Stepping::kBackwardEuler));
  for (const double end : {0.01, 0.02}) {
    ASSERT_TRUE(direct.To(end));
    ASSERT_TRUE(iterative.To(end));
  }
  EXPECT_LE(LargestDistance(direct.state.positions, iterative.state.positions), 1e-9);
}

// A soft box that falls from one side: inertia dominates and nothing locks, so conjugate gradients are used.
Scene FallingScene(ElementOrder element, LinearSolver solver) {
  Body body = BoxBody(Vec3::Constant(0.1), {6, 6, 6}, NeoHookean(std::array{1e4, 0.3}), CellsOf(element));
  body.constraints = {Fix(kX0)};
  Scene scene = StaticScene(std::move(body), element);
  scene.gravity.acceleration = Vec3(0, 0, -9.81);
  scene.tet.linear_solver = solver;
  scene.tet.stepping = Stepping::kBackwardEuler;
  scene.tet.time_step = 0.01;
  return scene;
}

TEST_P(IterativeTest, SoDoConjugateGradients) {
  SteppedRun direct(FallingScene(GetParam(), LinearSolver::kDirect));
  SteppedRun iterative(FallingScene(GetParam(), LinearSolver::kIterative));
  ASSERT_TRUE(direct.model.patches().empty());
  ASSERT_TRUE(direct.To(0.05));
  while (iterative.state.time < 0.05) {
    const StepReport report = iterative.solver.Advance(iterative.state, 0.05);
    ASSERT_EQ(report.problem, StepProblem::kNone);
    EXPECT_EQ(report.solves.direct, 0);
  }
  const std::size_t tip = direct.NodeAt(Vec3::Constant(0.1));
  ASSERT_GT(direct.Displacement(tip).norm(), 0.005);
  EXPECT_LE(LargestDistance(direct.state.positions, iterative.state.positions), 1e-9);
}

TEST_P(IterativeTest, ConjugateGradientsGiveTheSameBitsForAnyThreadsAndAfterARestart) {
  const Scene scene = FallingScene(GetParam(), LinearSolver::kIterative);
  const TetModel model(scene);
  const auto run = [&](int threads, bool restart) {
    ThreadTeam team(threads);
    auto solver = std::make_unique<TetStepper>(model, team);
    TetState state = solver->InitialState();
    for (int i = 1; i <= 3; ++i) {
      if (restart) solver = std::make_unique<TetStepper>(model, team);
      EXPECT_EQ(solver->Advance(state, 0.01 * i).problem, StepProblem::kNone);
    }
    return state.positions;
  };
  const NodalVector reference = run(1, false);
  EXPECT_EQ(run(3, false), reference);
  EXPECT_EQ(run(1, true), reference);
}

INSTANTIATE_TEST_SUITE_P(Elements, IterativeTest, ::testing::ValuesIn(kEveryElement),
                         [](const auto& element) { return ElementNameOf(element.param); });

// Problem d at 3 and 37 thousand unknown components.
TEST(IterativeGrowthTest, IterationsDoNotGrow) {
  const auto iterations = [](int n) {
    Scene scene = StaticScene(ReferenceMuscle(n, Ramp(0.3)), ElementOrder::kQuadratic);
    scene.tet.linear_solver = LinearSolver::kIterative;
    SteppedRun run(scene);
    const StepReport report = run.solver.Advance(run.state, 1);
    EXPECT_EQ(report.problem, StepProblem::kNone);
    EXPECT_EQ(report.solves.not_converged, 0);
    std::printf("%zu free components: %d Newton iterations, %d systems, %d iterations of GMRES, end force %.4f N\n",
                run.FreeComponents(), report.iterations, report.solves.iterative, report.solves.iterations,
                run.Reaction(1)[2]);
    return static_cast<double>(report.solves.iterations) / report.solves.iterative;
  };
  const double coarse = iterations(3), fine = iterations(7);
  EXPECT_LE(fine, 1.5 * coarse);
}

}  // namespace
}  // namespace fascicle
