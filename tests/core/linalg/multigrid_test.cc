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

// The operations of FlexibleGmres.
struct DenseSpace {
  Eigen::Index size;

  Eigen::VectorXd Zero() const { return Eigen::VectorXd::Zero(size); }
  double Dot(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const { return a.dot(b); }
  void Add(double scale, const Eigen::VectorXd& v, Eigen::VectorXd& sum) const { sum += scale * v; }
  void Scale(double scale, Eigen::VectorXd& v) const { v *= scale; }
};

// z = M r in the order of the nodes.
NodalVector Cycle(Multigrid& multigrid, const NodalVector& r, ThreadTeam& team) {
  const std::vector<std::int32_t>& row = multigrid.finest().order().row;
  FloatField b(r.size()), x;
  for (std::size_t i = 0; i < row.size(); ++i) b[i] << r[row[i]].cast<float>(), 0;
  multigrid.Apply(b, team, x);
  NodalVector z(r.size());
  for (std::size_t i = 0; i < row.size(); ++i) z[row[i]] = x[i].head<3>().cast<double>();
  return z;
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
    z = Flat(Cycle(multigrid, Nodal(r), team));
  };
  Solution solution;
  GmresWorkspace<Eigen::VectorXd> workspace;
  const Eigen::VectorXd b = Flat(RandomField(grid.free, 3));
  solution.result = FlexibleGmres(DenseSpace{b.size()}, apply, precondition, b, 1e-8, 60, solution.x, workspace);
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
  const NodalVector Ma = Cycle(multigrid, a, team), Mb = Cycle(multigrid, b, team);
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

// Chunks of a colour are not coupled, and every row has one place.
TEST(SweepOrderTest, ChunksOfAColourAreNotCoupled) {
  const SpringGrid grid(14);
  const SweepOrder order(grid.pattern, grid.positions);
  const std::size_t rows = grid.pattern.rows();
  ASSERT_EQ(order.row.size(), rows);
  ASSERT_EQ(order.chunk_begin.back(), static_cast<std::int32_t>(rows));
  ASSERT_EQ(order.colour_begin.back(), static_cast<std::int32_t>(order.chunk_begin.size() - 1));
  EXPECT_GT(order.colour_begin.size(), 3u);
  std::vector<std::int32_t> chunk_of(rows), colour_of(rows);
  for (std::size_t colour = 0; colour + 1 < order.colour_begin.size(); ++colour) {
    for (std::int32_t c = order.colour_begin[colour]; c < order.colour_begin[colour + 1]; ++c) {
      for (std::int32_t i = order.chunk_begin[c]; i < order.chunk_begin[c + 1]; ++i) {
        EXPECT_EQ(order.place[order.row[i]], i);
        chunk_of[order.row[i]] = c;
        colour_of[order.row[i]] = static_cast<std::int32_t>(colour);
      }
    }
  }
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::int32_t k = grid.pattern.begin[row]; k < grid.pattern.begin[row + 1]; ++k) {
      const std::int32_t other = grid.pattern.column[k];
      EXPECT_TRUE(colour_of[row] != colour_of[other] || chunk_of[row] == chunk_of[other]);
    }
  }
}

TEST(SweepMatrixTest, SweepsSolveTheirTriangles) {
  const SpringGrid grid(12);
  SweepMatrix matrix(grid.pattern, grid.positions);
  std::vector<FloatField> results;
  for (const int threads : {1, 3}) {
    ThreadTeam team(threads);
    matrix.SetValues(grid.values, team);
    const NodalVector random = RandomField(grid.free, 5);
    const std::size_t rows = matrix.rows();
    FloatField b(rows), x(rows), r(rows), product(rows);
    for (std::size_t i = 0; i < rows; ++i) b[i] << random[matrix.order().row[i]].cast<float>(), 0;
    const auto largest_residual = [&](const FloatField& expected) {
      matrix.Multiply(x, team, product);
      float largest = 0;
      for (std::size_t i = 0; i < rows; ++i) {
        largest = std::max(largest, (b[i] - product[i] - expected[i]).norm());
      }
      return largest;
    };
    // The product is that of the matrix.
    NodalVector of_b(rows), exact;
    for (std::size_t i = 0; i < rows; ++i) of_b[matrix.order().row[i]] = b[i].head<3>().cast<double>();
    matrix.Multiply(b, team, product);
    Multiply(grid.pattern, grid.values, of_b, team, exact);
    for (std::size_t i = 0; i < rows; ++i) {
      EXPECT_LE((exact[matrix.order().row[i]] - product[i].head<3>().cast<double>()).norm(), 2e-5);
    }
    // (L + D) x = b.
    matrix.SweepFromZero(b, team, x);
    matrix.ResidualAfterSweep(x, team, r);
    EXPECT_LE(largest_residual(r), 1e-5f);
    // Both ways to sweep back are the same.
    FloatField back = x;
    matrix.SweepBackFromSweep(team, back);
    matrix.SweepBack(b, team, x);
    for (std::size_t i = 0; i < rows; ++i) EXPECT_LE((x[i] - back[i]).norm(), 1e-5f);
    results.push_back(x);
  }
  EXPECT_EQ(results[0], results[1]);
}

TEST(GmresTest, SolvesNonsymmetricAndTellsIndefinite) {
  constexpr int kSize = 40;
  std::srand(7);
  Eigen::MatrixXd A = Eigen::MatrixXd::Random(kSize, kSize) + 8 * Eigen::MatrixXd::Identity(kSize, kSize);
  const Eigen::VectorXd b = Eigen::VectorXd::Random(kSize);
  const DenseSpace space{kSize};
  GmresWorkspace<Eigen::VectorXd> workspace;
  Eigen::VectorXd x;
  const auto same = [](const Eigen::VectorXd& r, Eigen::VectorXd& z) { z = r; };
  const auto apply = [&](const Eigen::VectorXd& v, Eigen::VectorXd& Av) { Av = A * v; };
  const GmresResult result = FlexibleGmres(space, apply, same, b, 1e-12, kSize, x, workspace);
  EXPECT_TRUE(result.converged);
  EXPECT_LE((x - A.lu().solve(b)).norm(), 1e-10 * x.norm());
  EXPECT_GT(result.least_eigenvalue, 0);
  // One negative eigenvalue ends the iteration early.
  A = Eigen::VectorXd::LinSpaced(kSize, 1, 2).asDiagonal();
  A(5, 5) = -1;
  const GmresResult indefinite = FlexibleGmres(space, apply, same, b, 1e-12, kSize, x, workspace);
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
