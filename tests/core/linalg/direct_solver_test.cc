#include "core/linalg/direct_solver.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <random>
#include <thread>
#include <vector>

namespace fascicle {
namespace {

// A random sparse symmetric matrix with some negative eigenvalues, its lower triangle as entries.
struct Problem {
  explicit Problem(int size, unsigned seed) : dense(Eigen::MatrixXd::Zero(size, size)) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> value(-1, 1);
    for (int i = 0; i < size; ++i) {
      for (int j = 0; j <= i; ++j) {
        if (i != j && random() % 4 != 0) continue;
        const double entry = i == j ? (i % 3 == 0 ? -4.0 : 5.0) + value(random) : value(random);
        rows.push_back(i);
        columns.push_back(j);
        values.push_back(entry);
        dense(i, j) = dense(j, i) = entry;
      }
    }
  }

  Eigen::MatrixXd dense;
  std::vector<std::int32_t> rows, columns;
  std::vector<double> values;
};

double ErrorOf(DirectSolver& solver, const Eigen::MatrixXd& A) {
  const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(A.rows(), -1, 2);
  Eigen::VectorXd b = A * x;
  solver.Solve(std::span(b.data(), static_cast<std::size_t>(b.size())));
  return (b - x).norm() / x.norm();
}

TEST(DirectSolverTest, SolvesAndCountsNegativeEigenvalues) {
  const Problem problem(60, 1);
  DirectSolver solver;
  ASSERT_TRUE(solver.Analyze(60, problem.rows, problem.columns));
  const DirectSolver::Factored factored = solver.Factor(problem.values);
  ASSERT_TRUE(factored.ok);
  const Eigen::VectorXd eigenvalues = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(problem.dense).eigenvalues();
  EXPECT_EQ(factored.negative_pivots, (eigenvalues.array() < 0).count());
  EXPECT_GT(factored.negative_pivots, 5);
  EXPECT_LT(ErrorOf(solver, problem.dense), 1e-11);
}

TEST(DirectSolverTest, TakesNewValuesForTheSamePattern) {
  Problem problem(40, 2);
  DirectSolver solver;
  ASSERT_TRUE(solver.Analyze(40, problem.rows, problem.columns));
  ASSERT_TRUE(solver.Factor(problem.values).ok);
  for (double& value : problem.values) value *= -3;
  ASSERT_TRUE(solver.Factor(problem.values).ok);
  EXPECT_LT(ErrorOf(solver, -3 * problem.dense), 1e-11);
}

TEST(DirectSolverTest, SingularIsNotOk) {
  DirectSolver solver;
  const std::vector<std::int32_t> rows = {0, 1, 1}, columns = {0, 0, 1};
  ASSERT_TRUE(solver.Analyze(2, rows, columns));
  EXPECT_FALSE(solver.Factor(std::vector{1.0, 1.0, 1.0}).ok);
  EXPECT_TRUE(solver.Factor(std::vector{1.0, 0.5, 1.0}).ok);
}

// Several threads solve at the same time; each gets the same bits as alone.
TEST(DirectSolverTest, SolversInSeveralThreadsDoNotMix) {
  const auto solve = [](unsigned seed) {
    const Problem problem(80, seed);
    DirectSolver solver;
    EXPECT_TRUE(solver.Analyze(80, problem.rows, problem.columns));
    std::vector<double> b(80, 1.0);
    for (int i = 0; i < 20; ++i) {
      EXPECT_TRUE(solver.Factor(problem.values).ok);
      solver.Solve(b);
    }
    return b;
  };
  std::vector<std::vector<double>> alone, together(4);
  for (unsigned k = 0; k < 4; ++k) alone.push_back(solve(k));
  std::vector<std::jthread> threads;
  for (unsigned k = 0; k < 4; ++k) threads.emplace_back([&, k] { together[k] = solve(k); });
  threads.clear();
  EXPECT_EQ(alone, together);
}

}  // namespace
}  // namespace fascicle
