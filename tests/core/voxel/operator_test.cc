#include "core/voxel/voxel_operator.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <cstring>

#include "tests/support/voxel_scenes.h"

namespace fascicle {
namespace {

using testing::RandomField;
using testing::SpongeGrid;

const Vec3 kSpacing(0.9e-3, 1.1e-3, 1.6e-3);
const VoxelMaterial kMuscle = {3e4, 0.45};

// K of a brick by definition, the sum over Gauss points of B^T D B.
BrickMatrix ByGaussPoints(const Vec3& spacing, const VoxelMaterial& material, Dilatation dilatation) {
  const double mu = material.young_modulus / (2 * (1 + material.poisson_ratio));
  const double lambda = 2 * mu * material.poisson_ratio / (1 - 2 * material.poisson_ratio);
  std::vector<Eigen::Matrix<double, 6, 24>> strains;
  Eigen::Matrix<double, 1, 24> mean_trace = Eigen::Matrix<double, 1, 24>::Zero();
  for (int point = 0; point < 8; ++point) {
    const Vec3 xi = Vec3(point & 1 ? 1 : -1, point & 2 ? 1 : -1, point & 4 ? 1 : -1) / std::sqrt(3.0);
    const auto gradients = BrickGradients(spacing, xi);
    Eigen::Matrix<double, 6, 24> B = Eigen::Matrix<double, 6, 24>::Zero();
    for (int c = 0; c < 8; ++c) {
      const Vec3 g = gradients.col(c);
      for (int d = 0; d < 3; ++d) B(d, 3 * c + d) = g[d];
      B(3, 3 * c) = g[1], B(3, 3 * c + 1) = g[0];
      B(4, 3 * c + 1) = g[2], B(4, 3 * c + 2) = g[1];
      B(5, 3 * c) = g[2], B(5, 3 * c + 2) = g[0];
    }
    mean_trace += B.topRows<3>().colwise().sum() / 8;
    strains.push_back(B);
  }
  Eigen::Matrix<double, 6, 6> D = Eigen::Matrix<double, 6, 6>::Zero();
  D.topLeftCorner<3, 3>().setConstant(lambda);
  D.diagonal() += mu * Eigen::Matrix<double, 6, 1>(2, 2, 2, 1, 1, 1);
  BrickMatrix K = BrickMatrix::Zero();
  for (Eigen::Matrix<double, 6, 24> B : strains) {
    if (dilatation == Dilatation::kMean) {
      const Eigen::Matrix<double, 1, 24> change = (mean_trace - B.topRows<3>().colwise().sum()) / 3;
      for (int d = 0; d < 3; ++d) B.row(d) += change;
    }
    K += spacing.prod() / 8 * B.transpose() * D * B;
  }
  return K;
}

TEST(BrickStiffness, IsThatOfEightGaussPoints) {
  for (const Dilatation dilatation : {Dilatation::kFull, Dilatation::kMean}) {
    const BrickMatrix K = BrickStiffness(kSpacing, ModuliOf(kMuscle, dilatation));
    const BrickMatrix expected = ByGaussPoints(kSpacing, kMuscle, dilatation);
    EXPECT_LT((K - expected).norm(), 1e-14 * expected.norm());
    EXPECT_LT((BrickDiagonal(kSpacing, ModuliOf(kMuscle, dilatation)) - expected.diagonal().tail<3>()).norm(),
              1e-14 * expected.norm());
  }
}

TEST(BrickStiffness, HasSixRigidModesAndNoOthers) {
  for (const Dilatation dilatation : {Dilatation::kFull, Dilatation::kMean}) {
    const Eigen::SelfAdjointEigenSolver<BrickMatrix> eigen(BrickStiffness(kSpacing, ModuliOf(kMuscle, dilatation)));
    EXPECT_LT(eigen.eigenvalues().head<6>().cwiseAbs().maxCoeff(), 1e-13 * eigen.eigenvalues()[23]);
    EXPECT_GT(eigen.eigenvalues()[6], 1e-4 * eigen.eigenvalues()[23]);
  }
}

// K x element by element.
Eigen::VectorXd ByElements(const VoxelMesh& mesh, const VoxelStiffness& stiffness, const VoxelField<double>& x) {
  std::vector<BrickMatrix> K;
  for (const BrickModuli<double>& moduli : stiffness.moduli) K.push_back(BrickStiffness(mesh.spacing(), moduli));
  Eigen::VectorXd y = Eigen::VectorXd::Zero(3 * static_cast<Eigen::Index>(mesh.nodes()));
  for (const VoxelRun& run : mesh.runs()) {
    ForVoxelsOfRun(run, [&](std::int32_t voxel, const GridIndex&, const std::array<std::int32_t, 8>& nodes) {
      BrickVector u;
      for (int c = 0; c < 8; ++c) u.segment<3>(3 * c) = x.At(nodes[c]);
      const BrickVector f = static_cast<double>(stiffness.scale[voxel]) * (K[run.material] * u);
      for (int c = 0; c < 8; ++c) y.segment<3>(3 * static_cast<Eigen::Index>(nodes[c])) += f.segment<3>(3 * c);
    });
  }
  return y;
}

template <class S>
double LargestDifference(const VoxelField<S>& y, const Eigen::VectorXd& expected) {
  double largest = 0;
  for (std::int32_t n = 0; n < y.nodes(); ++n) {
    largest =
        std::max(largest, (y.At(n) - expected.segment<3>(3 * static_cast<Eigen::Index>(n))).cwiseAbs().maxCoeff());
  }
  return largest / expected.cwiseAbs().maxCoeff();
}

struct Sponge {
  explicit Sponge(const GridIndex& size, Dilatation dilatation = Dilatation::kFull)
      : grid(SpongeGrid(size, kSpacing)),
        mesh(grid),
        stiffness(mesh, {kMuscle, {1e6, 0.3}}, dilatation, StiffnessOfVoxels(grid)) {}
  VoxelGrid grid;
  VoxelMesh mesh;
  VoxelStiffness stiffness;
};

// Sizes around the widths of vectors, and one with several slabs.
TEST(VoxelOperator, IsTheSumOfItsBricks) {
  ThreadTeam team(1);
  for (const GridIndex& size :
       {GridIndex{1, 1, 1}, {2, 3, 1}, {7, 2, 3}, {8, 3, 2}, {15, 5, 4}, {16, 4, 5}, {17, 6, 6}, {37, 30, 33}}) {
    for (const Dilatation dilatation : {Dilatation::kFull, Dilatation::kMean}) {
      const Sponge s(size, dilatation);
      if (s.mesh.voxels() == 0) continue;
      const VoxelField<double> x = RandomField<double>(s.mesh.nodes());
      const Eigen::VectorXd expected = ByElements(s.mesh, s.stiffness, x);
      VoxelField<double> y(s.mesh.nodes());
      VoxelOperator<double>(s.stiffness).Apply(x, team, y);
      EXPECT_LT(LargestDifference(y, expected), 1e-14) << size[0];
      VoxelField<float> x_float(s.mesh.nodes()), y_float(s.mesh.nodes());
      for (std::size_t k = 0; k < x.size(); ++k) x_float.data()[k] = static_cast<float>(x.data()[k]);
      VoxelOperator<float>(s.stiffness).Apply(x_float, team, y_float);
      EXPECT_LT(LargestDifference(y_float, expected), 2e-6) << size[0];
      for (int d = 0; d < 3; ++d) {
        for (std::size_t k = s.mesh.nodes(); k < y.stride(); ++k) ASSERT_EQ(y.component(d)[k], 0);
      }
    }
  }
}

template <class S>
void ExpectSameBits() {
  const Sponge s({45, 40, 50});
  ASSERT_GT(s.mesh.slabs().size(), 4u);
  const VoxelField<S> x = RandomField<S>(s.mesh.nodes());
  VoxelField<S> expected(s.mesh.nodes());
  ThreadTeam one(1);
  VoxelOperator<S>(s.stiffness, &VoxelKernelsFor(InstructionSet::kBaseline)).Apply(x, one, expected);
  for (const InstructionSet set : kInstructionSets) {
    if (!IsAvailable(set)) continue;
    for (const int threads : {1, 2, 3}) {
      ThreadTeam team(threads);
      VoxelField<S> y(s.mesh.nodes());
      VoxelOperator<S>(s.stiffness, &VoxelKernelsFor(set)).Apply(x, team, y);
      EXPECT_EQ(std::memcmp(y.data(), expected.data(), y.size() * sizeof(S)), 0)
          << threads << " threads, instruction set " << static_cast<int>(set);
    }
  }
}

TEST(VoxelOperator, HasTheSameBitsForAnyThreadsAndInstructionSet) {
  ExpectSameBits<double>();
  ExpectSameBits<float>();
}

TEST(VoxelOperator, DiagonalIsThatOfTheMatrix) {
  const Sponge s({5, 4, 3});
  const VoxelField<float> diagonal = DiagonalOf(s.stiffness);
  ThreadTeam team(1);
  const VoxelOperator<double> K(s.stiffness);
  VoxelField<double> x(s.mesh.nodes()), y(s.mesh.nodes());
  for (std::int32_t n = 0; n < s.mesh.nodes(); ++n) {
    for (int d = 0; d < 3; ++d) {
      x(n, d) = 1;
      K.Apply(x, team, y);
      EXPECT_NEAR(diagonal(n, d), y(n, d), 1e-6 * y(n, d));
      x(n, d) = 0;
    }
  }
}

}  // namespace
}  // namespace fascicle
