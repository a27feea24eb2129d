#include "core/linalg/direct_solver.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <new>
#include <random>
#include <stop_token>
#include <thread>
#include <vector>

#include "core/base/stop.h"
#include "core/linalg/elimination_order.h"
#include "core/linalg/mumps_factors.h"

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

// Differences of neighbours in a grid of n^3 nodes, quasi-definite: every seventh unknown has a negative diagonal.
struct Differences {
  explicit Differences(std::int32_t n) : size(n * n * n) {
    const auto add = [this](std::int32_t row, std::int32_t column, double value) {
      rows.push_back(row);
      columns.push_back(column);
      values.push_back(value);
    };
    for (std::int32_t i = 0; i < size; ++i) {
      add(i, i, i % 7 == 0 ? -7 : 7);
      if (i % n > 0) add(i, i - 1, -1);
      if (i / n % n > 0) add(i, i - n, -1);
      if (i / (n * n) > 0) add(i, i - n * n, -1);
    }
  }

  std::int32_t size;
  std::vector<std::int32_t> rows, columns;
  std::vector<double> values;
};

std::vector<double> Ones(std::int32_t size) { return std::vector<double>(static_cast<std::size_t>(size), 1.0); }

// The processes that this one has started.
std::vector<pid_t> Children() {
  std::vector<pid_t> children;
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
    std::ifstream file(task.path() / "children");
    for (pid_t child = 0; file >> child;) children.push_back(child);
  }
  return children;
}

TEST(DirectSolverTest, ALargeSystemHasTheSameBitsInAProcessOfItsOwn) {
  const Differences grid(20);
  DirectSolver solver;
  ASSERT_TRUE(solver.Analyze(grid.size, grid.rows, grid.columns));
  EXPECT_EQ(Children().size(), 1U);
  MumpsFactors here;
  ASSERT_TRUE(here.Analyze(EliminationOrder(grid.size, grid.rows, grid.columns), grid.rows, grid.columns));
  std::vector<double> values = grid.values, by_solver = Ones(grid.size), by_factors = by_solver;
  for (const double factor : {1.0, -2.0}) {  // new values for the same pattern
    for (double& value : values) value *= factor;
    const DirectSolver::Factored there = solver.Factor(values);
    ASSERT_TRUE(there.ok);
    EXPECT_EQ(there.negative_pivots, here.Factor(values).negative_pivots);
    solver.Solve(by_solver);
    ASSERT_TRUE(here.Solve(by_factors));
    EXPECT_EQ(by_solver, by_factors);
  }
  EXPECT_GT(std::abs(by_solver.front()), 0);
}

TEST(DirectSolverTest, NobodyWaitsForALargeSystemWhichAStopRequestEnds) {
  const Differences large(64);
  std::stop_source stop;
  std::atomic<bool> is_factoring = false, is_over = false;
  std::thread other([&] {
    DirectSolver solver(stop.get_token());
    try {
      EXPECT_TRUE(solver.Analyze(large.size, large.rows, large.columns));
      is_factoring = true;
      solver.Factor(large.values);
      ADD_FAILURE() << "it ended before it was stopped";
    } catch (const Stopped&) {
    }
    is_over = true;
  });
  while (!is_factoring) std::this_thread::yield();
  const Differences small(10);
  for (int i = 0; i < 5; ++i) {
    DirectSolver solver;
    EXPECT_TRUE(solver.Analyze(small.size, small.rows, small.columns));
    EXPECT_TRUE(solver.Factor(small.values).ok);
  }
  EXPECT_FALSE(is_over) << "the small systems waited";
  const auto request = std::chrono::steady_clock::now();
  stop.request_stop();
  other.join();
  EXPECT_LT(std::chrono::steady_clock::now() - request, std::chrono::seconds(2));
  EXPECT_TRUE(Children().empty());
}

TEST(DirectSolverTest, AProcessThatIsKilledIsNoEndOfThisOne) {
  const Differences grid(20);
  DirectSolver solver;
  ASSERT_TRUE(solver.Analyze(grid.size, grid.rows, grid.columns));
  ASSERT_TRUE(solver.Factor(grid.values).ok);
  for (const pid_t child : Children()) kill(child, SIGKILL);
  std::vector<double> b = Ones(grid.size);
  EXPECT_THROW(solver.Solve(b), std::bad_alloc);
  EXPECT_FALSE(solver.Factor(grid.values).ok);
}

}  // namespace
}  // namespace fascicle
