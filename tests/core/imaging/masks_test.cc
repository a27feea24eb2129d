// Operations on masks against their definitions.
#include <gtest/gtest.h>

#include <random>

#include "core/imaging/masks.h"

namespace fascicle::testing {
namespace {

VoxelGrid RandomGrid(const GridIndex& size, const Vec3& spacing, unsigned percent) {
  VoxelGrid grid = MakeVoxelGrid(size, spacing);
  std::mt19937 random(2);
  for (std::uint8_t& material : grid.material) material = random() % 100 < percent ? 1 + random() % 2 : 0;
  return grid;
}

// Whether any solid (or empty) voxel of `grid` is within the radius; by brute force.
bool NearOne(const VoxelGrid& grid, const GridIndex& from, double radius, bool solid) {
  bool near = false;
  ForVoxels(grid, [&](std::size_t v, const GridIndex& at) {
    if ((grid.material[v] != 0) == solid && (grid.CornerAt(at) - grid.CornerAt(from)).norm() <= radius * (1 + 1e-9))
      near = true;
  });
  return near;
}

TEST(Masks, ErodesAndRestoresByABallInMetres) {
  const VoxelGrid grid = RandomGrid({11, 9, 6}, {1e-3, 1.5e-3, 2e-3}, 93);
  for (const int threads : {1, 3}) {
    ThreadTeam team(threads);
    for (const double radius : {1e-3, 1.5e-3, 2e-3, 2.6e-3}) {
      VoxelGrid eroded = grid;
      Erode(eroded, radius, team);
      ForVoxels(grid, [&](std::size_t v, const GridIndex& at) {
        ASSERT_EQ(eroded.material[v], NearOne(grid, at, radius, false) ? 0 : grid.material[v]) << radius;
      });
      VoxelGrid opened = eroded;
      Restore(opened, grid, radius, team);
      ForVoxels(grid, [&](std::size_t v, const GridIndex& at) {
        ASSERT_EQ(opened.material[v], NearOne(eroded, at, radius, true) ? grid.material[v] : 0) << radius;
      });
    }
  }
}

TEST(Masks, OpeningCutsBridges) {
  // Two cubes of 5 joined by a bar of 1.
  VoxelGrid grid = MakeVoxelGrid({13, 5, 5}, Vec3::Constant(1e-3));
  ForVoxels(grid, [&](std::size_t v, const GridIndex& at) {
    const bool bar = at[1] == 2 && at[2] == 2;
    grid.material[v] = at[0] < 5 || at[0] > 7 || bar ? 1 : 0;
  });
  const VoxelGrid whole = grid;
  ThreadTeam team(1);
  Erode(grid, 1e-3, team);
  EXPECT_EQ(FindIslands(grid).voxels.size(), 2u);
  KeepIslandsOf(grid, {{10, 2, 2}});
  Restore(grid, whole, 1e-3, team);
  EXPECT_EQ(grid.MaterialAt({2, 2, 2}), 0);
  EXPECT_EQ(grid.MaterialAt({6, 2, 2}), 0);
  EXPECT_EQ(grid.MaterialAt({12, 4, 4}), 1);
}

TEST(Masks, NothingOrAllIsLeftAsItIs) {
  ThreadTeam team(1);
  for (const int material : {0, 1}) {
    VoxelGrid grid = MakeVoxelGrid({3, 4, 5}, Vec3::Ones());
    std::fill(grid.material.begin(), grid.material.end(), material);
    const VoxelGrid before = grid;
    Erode(grid, 2, team);
    Restore(grid, before, 2, team);
    FillHoles(grid);
    EXPECT_EQ(grid.material, before.material);
  }
}

TEST(Masks, KeepsTheIslandsOfSeeds) {
  VoxelGrid grid = MakeVoxelGrid({7, 1, 1}, Vec3::Ones());
  grid.material = {1, 0, 2, 2, 0, 3, 0};
  VoxelGrid two = grid;
  KeepIslandsOf(two, {{3, 0, 0}, {5, 0, 0}, {2, 0, 0}});
  EXPECT_EQ(two.material, (std::vector<std::uint8_t>{0, 0, 2, 2, 0, 3, 0}));
}

TEST(Masks, FillsWhatIsClosedAllRound) {
  VoxelGrid grid = MakeVoxelGrid({9, 7, 7}, Vec3::Ones());
  std::fill(grid.material.begin(), grid.material.end(), 1);
  // A hole of two voxels beside material 2, and a tunnel to the side.
  for (int j = 1; j < 4; ++j) grid.material[grid.IndexOf({1, j, 2})] = 2;
  for (int i = 1; i < 3; ++i) {
    for (const GridIndex& around : {GridIndex{i, 1, 1}, GridIndex{i, 3, 1}, GridIndex{i, 2, 2}, GridIndex{i, 2, 0}}) {
      grid.material[grid.IndexOf(around)] = 2;
    }
    grid.material[grid.IndexOf({i, 2, 1})] = 0;
  }
  for (int k = 4; k < 7; ++k) grid.material[grid.IndexOf({6, 3, k})] = 0;
  FillHoles(grid);
  EXPECT_EQ(grid.MaterialAt({1, 2, 1}), 2);
  EXPECT_EQ(grid.MaterialAt({2, 2, 1}), 2);
  for (int k = 4; k < 7; ++k) EXPECT_EQ(grid.MaterialAt({6, 3, k}), 0);
}

TEST(Masks, Dice) {
  VoxelGrid a = MakeVoxelGrid({4, 1, 1}, Vec3::Ones()), b = a;
  EXPECT_EQ(DiceOverlap(a, b), 1);
  a.material = {1, 1, 1, 0};
  EXPECT_EQ(DiceOverlap(a, b), 0);
  b.material = {0, 2, 2, 2};
  EXPECT_DOUBLE_EQ(DiceOverlap(a, b), 2.0 * 2 / 6);
}

}  // namespace
}  // namespace fascicle::testing
