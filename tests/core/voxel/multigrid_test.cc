#include "core/voxel/multigrid.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstring>

#include "tests/support/voxel_scenes.h"

namespace fascicle {
namespace {

using testing::RandomField;
using testing::SpongeGrid;

// Symmetric and positive definite, as conjugate gradients require.
void ExpectSymmetricAndPositive(const VoxelGrid& grid, const std::string& description) {
  const VoxelMesh mesh(grid);
  const VoxelStiffness stiffness(mesh, {{3e4, 0.3}, {3e6, 0.4}}, Dilatation::kFull, StiffnessOfVoxels(grid));
  FixedComponents fixed(mesh.nodes(), 0);
  for (std::int32_t n = 0; n < mesh.nodes(); n += 97) fixed[n] = static_cast<std::uint8_t>(1 + n % 7);
  BrickRotations<float> turned(mesh.voxels());
  const Mat3 R = Eigen::AngleAxisd(1.2, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  for (std::int32_t v = 0; v < mesh.voxels(); v += 2) {
    for (int k = 0; k < 9; ++k) turned.component(k)[v] = static_cast<float>(R(k % 3, k / 3));
  }
  const std::vector<double> shift(mesh.nodes(), 5);
  ThreadTeam team(1);
  VoxelMultigrid plain(mesh, stiffness, fixed, team), shifted(mesh, stiffness, fixed, team, shift),
      of_turned(mesh, stiffness, fixed, team, {}, turned);
  for (VoxelMultigrid* multigrid : {&plain, &shifted, &of_turned}) {
    ASSERT_TRUE(multigrid->ok());
    EXPECT_THAT(multigrid->Description(), ::testing::HasSubstr(description));
    VoxelField<double> r(mesh.nodes()), Mr(mesh.nodes()), s(mesh.nodes()), Ms(mesh.nodes());
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      for (std::int32_t n = 0; n < mesh.nodes(); ++n) {
        for (int d = 0; d < 3; ++d) {
          r(n, d) = HashedUnit(seed * 100'000 + 3 * n + d);
          s(n, d) = n % 20 == 0 ? HashedUnit(seed * 200'000 + 3 * n + d) : 0;
        }
      }
      multigrid->Apply(r, team, Mr);
      multigrid->Apply(s, team, Ms);
      const double size = std::sqrt(Dot(team, r, Mr) * Dot(team, s, Ms));
      ASSERT_GT(size, 0);
      EXPECT_NEAR(Dot(team, r, Ms), Dot(team, s, Mr), 1e-5 * size);
      for (std::int32_t n = 0; n < mesh.nodes(); ++n) {
        for (int d = 0; d < 3; ++d) {
          if (fixed[n] >> d & 1) {
            EXPECT_EQ(Mr(n, d), 0);
          }
        }
      }
    }
  }
}

TEST(Multigrid, IsSymmetricAndPositive) {
  VoxelGrid grid = SpongeGrid({12, 8, 16}, Vec3::Constant(1e-3));
  for (std::uint8_t& material : grid.material) material = std::max<std::uint8_t>(material, 1);
  ExpectSymmetricAndPositive(grid, "1536 + 192 (192 of their own) + 24");
}

TEST(Multigrid, IsSymmetricAndPositiveWithRigidPieces) {
  VoxelGrid grid = SpongeGrid({11, 10, 13}, Vec3::Constant(1e-3));
  KeepLargestIsland(grid);
  ExpectSymmetricAndPositive(grid, "pieces");
}

// Interpolation of a linear field is exact, and restriction is its transpose.
TEST(Transfer, InterpolatesLinearlyAndHasItsTranspose) {
  const VoxelGrid grid = SpongeGrid({21, 14, 17}, Vec3::Ones());
  const VoxelMesh fine(grid);
  const VoxelMesh coarse = LevelStiffness::CoarserMesh(fine);
  const auto set_linear = [](const VoxelMesh& mesh, float spacing, VoxelField<float>& u) {
    std::int32_t n = 0;
    for (const GridIndex& at : mesh.NodePlaces()) {
      for (int d = 0; d < 3; ++d) u(n, d) = spacing * static_cast<float>(at[d] + 2 * at[(d + 1) % 3]) + 1;
      ++n;
    }
  };
  VoxelField<float> u(coarse.nodes()), expected(fine.nodes()), carried(fine.nodes()), back(coarse.nodes());
  set_linear(coarse, 2, u);
  set_linear(fine, 1, expected);
  const VoxelField<float> w = RandomField<float>(fine.nodes());
  for (const int threads : {1, 2}) {
    ThreadTeam team(threads);
    for (const InstructionSet set : kInstructionSets) {
      if (!IsAvailable(set)) continue;
      const VoxelTransfer transfer(fine, coarse, &VoxelKernelsFor(set));
      transfer.Interpolate(u, team, carried);
      EXPECT_EQ(std::memcmp(carried.data(), expected.data(), expected.size() * sizeof(float)), 0);
      transfer.Transpose(w, team, back);
      EXPECT_NEAR(Dot(team, back, u), Dot(team, w, carried),
                  1e-5 * std::sqrt(Dot(team, w, w) * Dot(team, carried, carried)));
    }
  }
}

// K of a coarser level is P^T K P for any supports, holes and materials.
TEST(LevelStiffness, IsTheGalerkinProduct) {
  VoxelGrid grid = SpongeGrid({13, 10, 9}, Vec3(1, 1.5, 0.8));
  ForVoxels(grid, [&](std::size_t v, const GridIndex& at) {
    if (at[0] >= 6 && at[1] >= 4) grid.material[v] = 1;
    if (at[0] >= 6) grid.stiffness[v] = 2;
  });
  const VoxelMesh fine(grid);
  FixedComponents fixed(fine.nodes(), 0);
  for (std::int32_t n = 0; n < fine.nodes(); n += 61) fixed[n] = static_cast<std::uint8_t>(1 + n % 7);
  ThreadTeam team(2);
  const LevelStiffness K(fine, VoxelStiffness(fine, {{1, 0.3}, {5, 0.4}}, Dilatation::kFull, StiffnessOfVoxels(grid)));
  const VoxelMesh coarse = LevelStiffness::CoarserMesh(fine);
  const LevelStiffness K_coarse(coarse, K, fixed, team);
  EXPECT_LT(K_coarse.own_matrices(), static_cast<std::size_t>(coarse.voxels()));
  const VoxelTransfer transfer(fine, coarse);
  const VoxelField<float> u = RandomField<float>(coarse.nodes());
  VoxelField<float> Pu(fine.nodes()), KPu(fine.nodes()), expected(coarse.nodes()), product(coarse.nodes());
  const auto clear_fixed = [&](VoxelField<float>& field) {
    for (std::int32_t n = 0; n < fine.nodes(); ++n) {
      for (int d = 0; d < 3; ++d) {
        if (fixed[n] >> d & 1) field(n, d) = 0;
      }
    }
  };
  transfer.Interpolate(u, team, Pu);
  clear_fixed(Pu);
  K.Apply(Pu, team, KPu);
  clear_fixed(KPu);
  transfer.Transpose(KPu, team, expected);
  K_coarse.Apply(u, team, product);
  double difference = 0;
  for (std::size_t k = 0; k < product.size(); ++k) difference += std::pow(product.data()[k] - expected.data()[k], 2);
  EXPECT_LT(std::sqrt(difference), 1e-5 * std::sqrt(Dot(team, expected, expected)));
}

}  // namespace
}  // namespace fascicle
