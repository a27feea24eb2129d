// Conjugate gradients in single precision with iterative refinement, against residuals in double.
#include "core/linalg/mixed_precision_cg.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "spring_grid.h"

namespace fascicle {
namespace {

using testing::RandomField;
using testing::SpringGrid;

// `inertia` is added to the diagonal of free components, so that every eigenvalue is at least that.
struct HeavyGrid : SpringGrid {
  HeavyGrid(int side, double inertia) : SpringGrid(side), b(RandomField(free, 3)) {
    for (std::size_t i = 0; i < free.size(); ++i) {
      const auto n = static_cast<std::int32_t>(i);
      for (int c = 0; c < 3; ++c) values[pattern.PlaceOf(n, n)](c, c) += free[i][c] ? inertia : 0;
    }
  }

  MixedPrecisionCg::Result Solve(double tolerance, int max_iterations = 1000, int threads = 1) {
    ThreadTeam team(threads);
    cg.SetUp(pattern, values, team);
    return cg.Solve(pattern, values, b, tolerance, max_iterations, team, x);
  }
  // |b - A x| over |b| in the norm of D^-1.
  double Residual() const {
    ThreadTeam team(1);
    NodalVector product;
    Multiply(pattern, values, x, team, product);
    double left = 0, all = 0;
    for (std::size_t i = 0; i < b.size(); ++i) {
      const auto n = static_cast<std::int32_t>(i);
      const Mat3 inverse = values[pattern.PlaceOf(n, n)].inverse();
      const Vec3 r = b[i] - product[i];
      left += r.dot(inverse * r);
      all += b[i].dot(inverse * b[i]);
    }
    return std::sqrt(left / all);
  }

  MixedPrecisionCg cg;
  NodalVector b, x;
};

TEST(MixedPrecisionCgTest, RefinesBeyondSinglePrecision) {
  HeavyGrid grid(9, 0.05);
  for (const double tolerance : {1e-2, 1e-5, 1e-12}) {
    const auto result = grid.Solve(tolerance);
    EXPECT_TRUE(result.converged);
    EXPECT_TRUE(result.is_positive);
    EXPECT_GT(result.iterations, 3);
    EXPECT_LE(grid.Residual(), 1.01 * tolerance);
    EXPECT_GT(grid.Residual(), 1e-5 * tolerance);
  }
}

TEST(MixedPrecisionCgTest, HeldComponentsStay) {
  HeavyGrid grid(6, 0.05);
  EXPECT_TRUE(grid.Solve(1e-9).converged);
  for (std::size_t i = 0; i < grid.free.size(); ++i) {
    if (grid.free[i][0]) continue;
    EXPECT_EQ(grid.x[i], Vec3(Vec3::Zero()));
  }
}

TEST(MixedPrecisionCgTest, TellsIndefinite) {
  HeavyGrid grid(6, 0);
  const std::int32_t last = static_cast<std::int32_t>(grid.free.size()) - 1;
  grid.values[grid.pattern.PlaceOf(last, last)] -= 10 * Mat3::Identity();
  const auto result = grid.Solve(1e-9);
  EXPECT_FALSE(result.is_positive);
  EXPECT_FALSE(result.converged);
}

TEST(MixedPrecisionCgTest, SaysWhenItDoesNotConverge) {
  HeavyGrid grid(9, 0.05);
  const auto result = grid.Solve(1e-9, 5);
  EXPECT_FALSE(result.converged);
  EXPECT_TRUE(result.is_positive);
}

// Squares of these overflow in single precision.
TEST(MixedPrecisionCgTest, SmallAndNoForces) {
  HeavyGrid grid(6, 0.05);
  EXPECT_TRUE(grid.Solve(1e-9).converged);
  const NodalVector x = grid.x;
  for (Vec3& force : grid.b) force *= 0x1p-120;
  EXPECT_TRUE(grid.Solve(1e-9).converged);
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_LT((0x1p120 * grid.x[i] - x[i]).norm(), 1e-6 * x[i].norm() + 1e-9);
  grid.b.assign(grid.b.size(), Vec3::Zero());
  const auto result = grid.Solve(1e-9);
  EXPECT_TRUE(result.converged);
  EXPECT_EQ(result.iterations, 0);
  EXPECT_EQ(grid.x, grid.b);
}

TEST(MixedPrecisionCgTest, SameBitsForAnyThreads) {
  HeavyGrid grid(16, 0.05);
  grid.Solve(1e-6);
  const NodalVector x = grid.x;
  for (const int threads : {2, 3}) {
    grid.Solve(1e-6, 1000, threads);
    EXPECT_EQ(x, grid.x) << threads;
  }
}

TEST(PositiveInverseTest, OfAllSortsOfBlocks) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> value(-1, 1);
  for (int i = 0; i < 200; ++i) {
    Mat3 block = Mat3::NullaryExpr([&](Eigen::Index, Eigen::Index) { return value(random); });
    block = (block + block.transpose()).eval();
    if (i % 2 == 0) block = (block * block).eval();
    const Eigen::SelfAdjointEigenSolver<Mat3> eigen(block);
    const Vec3 values = eigen.eigenvalues().cwiseAbs();
    const Mat3 expected = eigen.eigenvectors() * values.cwiseMax(1e-6 * values.maxCoeff()).cwiseInverse().asDiagonal() *
                          eigen.eigenvectors().transpose();
    EXPECT_LT((PositiveInverse(block) - expected).norm(), 1e-9 * expected.norm());
  }
  EXPECT_EQ(PositiveInverse(Mat3::Zero()), Mat3(Mat3::Identity()));
}

}  // namespace
}  // namespace fascicle
