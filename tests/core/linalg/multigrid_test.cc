#include "core/linalg/multigrid.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "core/linalg/flexible_gmres.h"
#include "spring_grid.h"

namespace fascicle {
namespace {

using testing::RandomField;
using testing::SpringGrid;

Eigen::VectorXd Flat(const NodalVector& v) {
  return Eigen::Map<const Eigen::VectorXd>(v.front().data(), static_cast<Eigen::Index>(3 * v.size()));
}

NodalVector Nodal(const Eigen::VectorXd& flat) {
  NodalVector v(flat.size() / 3);
  for (std::size_t n = 0; n < v.size(); ++n) v[n] = flat.segment<3>(static_cast<Eigen::Index>(3 * n));
  return v;
}

struct Solution {
  GmresResult result;
  Eigen::VectorXd x;
};

Solution Solve(const SpringGrid& grid, Multigrid& multigrid, ThreadTeam& team) {
  EXPECT_TRUE(multigrid.SetUp(grid.values, team));
  NodalVector product;
  const auto apply = [&](const Eigen::VectorXd& v, Eigen::VectorXd& Av) {
    Multiply(grid.pattern, grid.values, Nodal(v), team, product);
    Av = Flat(product);
  };
  const auto precondition = [&](const Eigen::VectorXd& r, Eigen::VectorXd& z) {
    multigrid.Apply(Nodal(r), team, product);
    z = Flat(product);
  };
  Solution solution;
  GmresWorkspace workspace;
  solution.result =
      FlexibleGmres(team, apply, precondition, Flat(RandomField(grid.free, 3)), 1e-8, 60, solution.x, workspace);
  return solution;
}

TEST(MultigridTest, IterationsDoNotGrowWithTheSize) {
  ThreadTeam team(2);
  std::vector<int> iterations;
  for (const int n : {14, 20, 28}) {
    const SpringGrid grid(n);
    Multigrid multigrid(grid.pattern, grid.positions, grid.free, std::nullopt);
    const Solution solution = Solve(grid, multigrid, team);
    EXPECT_TRUE(solution.result.converged);
    EXPECT_GT(solution.result.least_eigenvalue, 0);
    NodalVector product;
    Multiply(grid.pattern, grid.values, Nodal(solution.x), team, product);
    const Eigen::VectorXd b = Flat(RandomField(grid.free, 3));
    EXPECT_LE((Flat(product) - b).norm(), 2e-8 * b.norm());
    iterations.push_back(solution.result.iterations);
    std::printf("%d nodes: %s, %d iterations\n", n * n * n, multigrid.Description().c_str(), iterations.back());
  }
  EXPECT_LE(iterations.back(), 25);
  EXPECT_LE(iterations.back(), iterations.front() + 6);
}

TEST(MultigridTest, TheCycleIsSymmetricAndPositive) {
  ThreadTeam team(1);
  const SpringGrid grid(14);
  Multigrid multigrid(grid.pattern, grid.positions, grid.free, std::nullopt);
  ASSERT_TRUE(multigrid.SetUp(grid.values, team));
  const NodalVector a = RandomField(grid.free, 1), b = RandomField(grid.free, 2);
  NodalVector Ma, Mb;
  multigrid.Apply(a, team, Ma);
  multigrid.Apply(b, team, Mb);
  EXPECT_NEAR(Dot(team, a, Mb), Dot(team, b, Ma), 1e-5 * std::sqrt(Dot(team, a, Ma) * Dot(team, b, Mb)));
  EXPECT_GT(Dot(team, a, Ma), 0);
  for (std::size_t n = 0; n < Ma.size(); ++n) {
    if (!grid.free[n][0]) {
      EXPECT_EQ(Ma[n], Vec3::Zero());
    }
  }
}

TEST(MultigridTest, SameBitsForAnyThreadsAndAfterForgetting) {
  const SpringGrid grid(15);
  ThreadTeam one(1), three(3);
  Multigrid multigrid(grid.pattern, grid.positions, grid.free, std::nullopt);
  const Solution reference = Solve(grid, multigrid, one);
  Multigrid other(grid.pattern, grid.positions, grid.free, std::nullopt);
  EXPECT_EQ(Solve(grid, other, three).x, reference.x);
  // Another matrix in between has no effect.
  SpringGrid stiffer = grid;
  for (std::size_t k = 0; k < stiffer.values.size(); k += 2) stiffer.values[k] *= 1.5;
  multigrid.ForgetAggregation();
  multigrid.SetUp(stiffer.values, one);
  multigrid.ForgetAggregation();
  EXPECT_EQ(Solve(grid, multigrid, one).x, reference.x);
}

TEST(GmresTest, SolvesNonsymmetricAndTellsIndefinite) {
  constexpr int kSize = 40;
  std::srand(7);
  Eigen::MatrixXd A = Eigen::MatrixXd::Random(kSize, kSize) + 8 * Eigen::MatrixXd::Identity(kSize, kSize);
  const Eigen::VectorXd b = Eigen::VectorXd::Random(kSize);
  ThreadTeam team(1);
  GmresWorkspace workspace;
  Eigen::VectorXd x;
  const auto same = [](const Eigen::VectorXd& r, Eigen::VectorXd& z) { z = r; };
  const auto apply = [&](const Eigen::VectorXd& v, Eigen::VectorXd& Av) { Av = A * v; };
  const GmresResult result = FlexibleGmres(team, apply, same, b, 1e-12, kSize, x, workspace);
  EXPECT_TRUE(result.converged);
  EXPECT_LE((x - A.lu().solve(b)).norm(), 1e-10 * x.norm());
  EXPECT_GT(result.least_eigenvalue, 0);
  // One negative eigenvalue ends the iteration early.
  A = Eigen::VectorXd::LinSpaced(kSize, 1, 2).asDiagonal();
  A(5, 5) = -1;
  const GmresResult indefinite = FlexibleGmres(team, apply, same, b, 1e-12, kSize, x, workspace);
  EXPECT_LT(indefinite.least_eigenvalue, 0);
  EXPECT_LE(indefinite.iterations, 2 * kRitzInterval);
}

TEST(BlockMatrixTest, TransposedPatternFindsEveryBlock) {
  const SpringGrid grid(4);
  const TransposedPattern transposed(grid.pattern, grid.pattern.rows());
  ASSERT_EQ(transposed.pattern.begin, grid.pattern.begin);  // symmetric
  for (std::size_t k = 0; k < grid.pattern.blocks(); ++k) {
    EXPECT_LE((grid.values[transposed.source[k]].transpose() - grid.values[k]).norm(), 1e-15);
  }
}

}  // namespace
}  // namespace fascicle
