// Distributions of force against their optimality conditions, and against a solver of another kind.
#include "core/skeleton/force_distribution.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <random>

namespace fascicle {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Problem {
  MatrixXd capacity;
  VectorXd demand;
};

class RandomProblems {
 public:
  explicit RandomProblems(unsigned seed) : random_(seed) {}

  // Coordinates and muscles of random strengths; some activations, many of them at a bound, meet the demand.
  Problem Feasible(int coordinates, int muscles) {
    Problem problem{MatrixXd(coordinates, muscles), VectorXd()};
    VectorXd a(muscles);
    for (Index m = 0; m < muscles; ++m) {
      const double strength = 100 * std::exp(normal_(random_));
      for (Index j = 0; j < coordinates; ++j) {
        problem.capacity(j, m) = uniform_(random_) < 0.3 ? 0 : 0.03 * strength * normal_(random_);
      }
      a[m] = std::clamp(1.5 * uniform_(random_) - 0.25, 0.0, 1.0);
    }
    problem.demand = problem.capacity * a;
    return problem;
  }
  Problem Infeasible(int coordinates, int muscles) {
    Problem problem = Feasible(coordinates, muscles);
    problem.demand[0] = 2 * problem.capacity.row(0).cwiseAbs().sum() + 1;
    return problem;
  }
  int Whole(int low, int high) { return std::uniform_int_distribution<int>(low, high)(random_); }

 private:
  std::mt19937 random_;
  std::normal_distribution<double> normal_;
  std::uniform_real_distribution<double> uniform_{0, 1};
};

// Multipliers y of the demand: a_m = clamp(c_m . y / 2, 0, 1) is optimal. By Newton's method on the dual, whose
// gradient is the lack: a path of its own to the solution.
VectorXd ByTheDual(const Problem& problem) {
  const VectorXd scale = problem.capacity.cwiseAbs().rowwise().maxCoeff().cwiseMax(1e-12);
  const MatrixXd A = scale.cwiseInverse().asDiagonal() * problem.capacity;
  const VectorXd b = problem.demand.cwiseQuotient(scale);
  VectorXd y = VectorXd::Zero(b.size());
  const auto activations = [&](const VectorXd& z) { return VectorXd((A.transpose() * z / 2).cwiseMax(0).cwiseMin(1)); };
  const auto dual = [&](const VectorXd& z) {
    const VectorXd a = activations(z);
    return a.squaredNorm() + z.dot(b - A * a);
  };
  for (int k = 0; k < 2000; ++k) {
    const VectorXd a = activations(y), gradient = b - A * a;
    if (gradient.norm() < 1e-13) break;
    MatrixXd H = 1e-10 * MatrixXd::Identity(b.size(), b.size());
    for (Index m = 0; m < a.size(); ++m) {
      if (a[m] > 0 && a[m] < 1) H += A.col(m) * A.col(m).transpose() / 2;
    }
    const VectorXd direction = H.ldlt().solve(gradient);
    double step = 1;
    while (step > 1e-12 && dual(y + step * direction) < dual(y) + 1e-4 * step * gradient.dot(direction)) step /= 2;
    y += step * direction;
  }
  return activations(y);
}

TEST(ForceDistributionTest, ThousandProblemsMeetTheConditionsAndAnotherSolver) {
  RandomProblems random(7);
  double demand_error = 0, stationarity = 0, objective = 0;
  int compared = 0;
  for (int k = 0; k < 1000; ++k) {
    const int coordinates = random.Whole(1, 6);
    const Problem problem = random.Feasible(coordinates, coordinates + random.Whole(2, 20));
    const Distribution found = ForceDistributor().Solve(problem.capacity, problem.demand);
    ASSERT_TRUE(found.feasible) << k;
    const VectorXd& a = found.activations;
    const VectorXd scale = problem.capacity.cwiseAbs().rowwise().sum().cwiseMax(1e-12);
    demand_error = std::max(demand_error, found.lack.cwiseQuotient(scale).cwiseAbs().maxCoeff());
    // Multipliers from the muscles that are at no bound, by least squares.
    std::vector<Index> free;
    for (Index m = 0; m < a.size(); ++m) {
      if (a[m] > 1e-9 && a[m] < 1 - 1e-9) free.push_back(m);
    }
    const MatrixXd A = scale.cwiseInverse().asDiagonal() * problem.capacity;
    if (!free.empty()) {
      const VectorXd y = MatrixXd(A(Eigen::all, free).transpose()).completeOrthogonalDecomposition().solve(2 * a(free));
      const VectorXd residual = A(Eigen::all, free).transpose() * y - 2 * a(free);
      stationarity = std::max(stationarity, residual.cwiseAbs().maxCoeff());
    }
    const VectorXd other = ByTheDual(problem);
    if ((problem.capacity * other - problem.demand).cwiseQuotient(scale).cwiseAbs().maxCoeff() > 1e-9) continue;
    ++compared;
    objective = std::max(objective, std::abs(other.squaredNorm() - a.squaredNorm()) / std::max(1.0, a.squaredNorm()));
  }
  std::printf("demand met to %.1e, stationary to %.1e; objective of another solver within %.1e (%d of 1000)\n",
              demand_error, stationarity, objective, compared);
  EXPECT_LT(demand_error, 1e-8);
  EXPECT_LT(stationarity, 1e-8);
  EXPECT_LT(objective, 1e-6);
  EXPECT_GT(compared, 900);
}

// A muscle whose pull would not help is idle, not almost idle; one that must do all it can is fully active.
TEST(ForceDistributionTest, BoundsHoldExactly) {
  MatrixXd capacity(1, 3);
  capacity << 10, 30, -20;
  const Distribution light = ForceDistributor().Solve(capacity, VectorXd::Constant(1, 4));
  ASSERT_TRUE(light.feasible);
  EXPECT_NEAR(light.activations[1], 4 * 30 / 1000.0, 1e-12);
  EXPECT_EQ(light.activations[2], 0);
  const Distribution heavy = ForceDistributor().Solve(capacity, VectorXd::Constant(1, 36));
  ASSERT_TRUE(heavy.feasible);
  EXPECT_NEAR(heavy.activations[0], 0.6, 1e-12);
  EXPECT_EQ(heavy.activations[1], 1);
  EXPECT_EQ(heavy.activations[2], 0);
}

// Beyond strength: said, and no activations within bounds lack less.
TEST(ForceDistributionTest, WhatCannotBeDoneIsSaidWithTheLeastLack) {
  RandomProblems random(11);
  for (int k = 0; k < 50; ++k) {
    const Problem problem = random.Infeasible(3, 8);
    const Distribution found = ForceDistributor().Solve(problem.capacity, problem.demand);
    ASSERT_FALSE(found.feasible);
    const VectorXd scale = problem.capacity.cwiseAbs().rowwise().maxCoeff();
    const auto lack = [&](const VectorXd& a) {
      return (problem.demand - problem.capacity * a).cwiseQuotient(scale).squaredNorm();
    };
    // The gradient of the lack points out of the bounds, or vanishes.
    const MatrixXd A = scale.cwiseInverse().asDiagonal() * problem.capacity;
    const VectorXd gradient = -A.transpose() * found.lack.cwiseQuotient(scale);
    for (Index m = 0; m < gradient.size(); ++m) {
      const double a = found.activations[m];
      if (a > 1e-7) {
        EXPECT_LT(gradient[m], 1e-6 * lack(found.activations)) << k << " " << m;
      }
      if (a < 1 - 1e-7) {
        EXPECT_GT(gradient[m], -1e-6 * lack(found.activations)) << k << " " << m;
      }
    }
  }
}

TEST(ForceDistributionTest, ACoordinateThatNoMuscleMovesLacksAll) {
  MatrixXd capacity(2, 1);
  capacity << 10, 0;
  const Distribution found = ForceDistributor().Solve(capacity, Eigen::Vector2d(5, 3));
  EXPECT_FALSE(found.feasible);
  EXPECT_NEAR(found.activations[0], 0.5, 1e-6);
  EXPECT_EQ(found.lack[1], 3);
}

TEST(ForceDistributionTest, AMotionOfThousandFramesAndFiftyMuscles) {
  RandomProblems random(5);
  const Problem first = random.Feasible(10, 50), last = random.Feasible(10, 50);
  ForceDistributor distributor;
  const auto start = std::chrono::steady_clock::now();
  for (int k = 0; k < 1000; ++k) {
    const double t = k / 999.0;
    const MatrixXd capacity = first.capacity + t * 0.2 * (last.capacity - first.capacity);
    EXPECT_TRUE(distributor.Solve(capacity, 0.5 * first.demand * (1 - 0.3 * t)).feasible) << k;
  }
  std::printf("%.2f s\n", std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
}

}  // namespace
}  // namespace fascicle
