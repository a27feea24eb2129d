#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/geometry/voxel_grid.h"
#include "core/geometry/voxel_mesh.h"
#include "tests/support/voxel_scenes.h"

namespace fascicle {
namespace {

using testing::BoxGrid;
using ::testing::ElementsAre;
using testing::SpongeGrid;

TEST(VoxelGrid, PlacesCornersByOriginSpacingAndDirection) {
  VoxelGrid grid = BoxGrid({2, 2, 2}, {1, 2, 3});
  grid.origin = {10, 20, 30};
  grid.direction << 0, 1, 0, -1, 0, 0, 0, 0, 1;
  EXPECT_EQ(grid.CornerAt({1, 2, 1}), Vec3(14, 19, 33));
}

TEST(Coarsen, KeepsWhatIsFullEnoughOfTheCommonestMaterial) {
  VoxelGrid grid = MakeVoxelGrid({4, 2, 3}, Vec3::Ones());
  grid.stiffness.assign(grid.voxels(), 0);
  const auto set = [&](const GridIndex& at, std::uint8_t material, float stiffness) {
    grid.material[grid.IndexOf(at)] = material;
    grid.stiffness[grid.IndexOf(at)] = stiffness;
  };
  set({0, 0, 0}, 2, 1);
  set({1, 0, 0}, 2, 2);
  set({0, 1, 1}, 1, 6);
  set({2, 1, 1}, 3, 1);  // one of eight
  set({0, 0, 2}, 1, 5);  // the last layer is padded
  set({1, 1, 2}, 2, 1);
  const VoxelGrid coarse = Coarsen(grid, 0.25);
  EXPECT_THAT(coarse.size, ElementsAre(2, 1, 2));
  EXPECT_EQ(coarse.spacing, Vec3(2, 2, 2));
  EXPECT_THAT(coarse.material, ElementsAre(2, 0, 1, 0));
  EXPECT_THAT(coarse.stiffness, ElementsAre(3, 0, 3, 0));
  EXPECT_THAT(Coarsen(grid, 0.5).material, ElementsAre(0, 0, 0, 0));
}

TEST(CropToSolid, KeepsPlacesInSpace) {
  VoxelGrid grid = MakeVoxelGrid({5, 4, 3}, {1, 2, 3});
  grid.material[grid.IndexOf({2, 1, 1})] = 1;
  grid.material[grid.IndexOf({3, 3, 1})] = 2;
  const VoxelGrid cropped = CropToSolid(grid);
  EXPECT_THAT(cropped.size, ElementsAre(2, 3, 1));
  EXPECT_EQ(cropped.CornerAt({0, 0, 0}), grid.CornerAt({2, 1, 1}));
  EXPECT_EQ(cropped.MaterialAt({1, 2, 0}), 2);
  EXPECT_EQ(CropToSolid(MakeVoxelGrid({3, 3, 3}, Vec3::Ones())).voxels(), 0u);
}

TEST(FindIslands, JoinsAcrossFacesOnly) {
  VoxelGrid grid = MakeVoxelGrid({3, 3, 1}, Vec3::Ones());
  for (const GridIndex& at : {GridIndex{0, 0, 0}, {1, 1, 0}, {2, 1, 0}, {2, 2, 0}}) grid.material[grid.IndexOf(at)] = 1;
  const Islands islands = FindIslands(grid);
  EXPECT_THAT(islands.voxels, ElementsAre(1, 3));
  EXPECT_THAT(islands.island, ElementsAre(0, -1, -1, -1, 1, 1, -1, -1, 1));
  KeepLargestIsland(grid);
  EXPECT_EQ(grid.MaterialAt({0, 0, 0}), 0);
  EXPECT_EQ(grid.MaterialAt({2, 2, 0}), 1);
}

TEST(MakeHierarchy, CountsVoxelsAndNodesOfEachLevel) {
  const std::vector<VoxelLevel> levels = MakeHierarchy(BoxGrid({8, 8, 4}, Vec3::Ones()), 0.5, 9);
  ASSERT_EQ(levels.size(), 4u);  // at the next one, an eighth of the only voxel
  EXPECT_EQ(levels[0].nodes, 9 * 9 * 5);
  EXPECT_EQ(levels[1].voxels, 4 * 4 * 2);
  EXPECT_EQ(levels[2].nodes, 3 * 3 * 2);
  EXPECT_EQ(levels[3].voxel_size, 8);
  EXPECT_EQ(levels[3].voxels, 1);
}

// By definition: there is a node wherever a solid voxel has a corner.
TEST(VoxelGrid, StopRequestsAreHeeded) {
  VoxelGrid grid = BoxGrid({4, 3, 2}, Vec3::Ones());
  std::stop_source source;
  source.request_stop();
  const std::stop_token stop = source.get_token();
  EXPECT_THROW(Coarsen(grid, 0.5, stop), Stopped);
  EXPECT_THROW(CropToSolid(grid, stop), Stopped);
  EXPECT_THROW(FindIslands(grid, stop), Stopped);
  EXPECT_THROW(MakeHierarchy(grid, 0.5, 2, stop), Stopped);
  EXPECT_THROW(KeepLargestIsland(grid, stop), Stopped);
  EXPECT_EQ(grid.material, BoxGrid({4, 3, 2}, Vec3::Ones()).material);
}

TEST(VoxelMesh, NumbersCornersOfSolidVoxelsInOrder) {
  const VoxelGrid grid = SpongeGrid({9, 7, 6}, Vec3::Ones());
  const VoxelMesh mesh(grid);
  std::int32_t next_node = 0, next_voxel = 0;
  for (std::int32_t k = 0; k <= 6; ++k) {
    for (std::int32_t j = 0; j <= 7; ++j) {
      for (std::int32_t i = 0; i <= 9; ++i) {
        bool solid = false;
        for (int c = 0; c < 8; ++c) solid |= grid.MaterialAt({i - (c & 1), j - (c >> 1 & 1), k - (c >> 2)}) != 0;
        EXPECT_EQ(mesh.NodeAt({i, j, k}), solid ? next_node++ : -1);
        EXPECT_EQ(mesh.VoxelAt({i, j, k}), grid.MaterialAt({i, j, k}) != 0 ? next_voxel++ : -1);
      }
    }
  }
  EXPECT_EQ(mesh.nodes(), next_node);
  EXPECT_EQ(mesh.voxels(), next_voxel);
  const std::vector<GridIndex> places = mesh.NodePlaces();
  for (std::int32_t n = 0; n < mesh.nodes(); ++n) EXPECT_EQ(mesh.NodeAt(places[n]), n);
  ForVoxels(mesh, [&](std::int32_t voxel, const GridIndex& at, const std::array<std::int32_t, 8>& nodes) {
    EXPECT_EQ(mesh.VoxelAt(at), voxel);
    for (int c = 0; c < 8; ++c) {
      EXPECT_EQ(nodes[c], mesh.NodeAt({at[0] + (c & 1), at[1] + (c >> 1 & 1), at[2] + (c >> 2)}));
    }
  });
}

TEST(VoxelMesh, CoarserHasAVoxelWhereverThereIsOne) {
  const VoxelGrid grid = SpongeGrid({9, 7, 6}, Vec3::Ones());
  const VoxelMesh fine(grid);
  const VoxelMesh coarse = VoxelMesh::Coarser(fine, [](const GridIndex&) { return 1; });
  const VoxelMesh expected(Coarsen(grid, 0.125));
  EXPECT_EQ(coarse.voxels(), expected.voxels());
  EXPECT_EQ(coarse.NodePlaces(), expected.NodePlaces());
}

TEST(VoxelMesh, SlabsCoverRunsAndEvenOnesShareNoNodes) {
  const VoxelMesh mesh(SpongeGrid({45, 40, 50}, Vec3::Ones()));
  ASSERT_GT(mesh.slabs().size(), 4u);
  std::int32_t run = 0;
  for (std::size_t s = 0; s < mesh.slabs().size(); ++s) {
    const VoxelSlab& slab = mesh.slabs()[s];
    EXPECT_EQ(slab.first_run, run);
    run = slab.end_run;
    if (s >= 2) {
      EXPECT_GE(slab.first_node, mesh.slabs()[s - 2].end_node);
    }
    for (std::int32_t r = slab.first_run; r < slab.end_run; ++r) {
      EXPECT_GE(mesh.runs()[r].node[0], slab.first_node);
      EXPECT_LT(mesh.runs()[r].node[3] + mesh.runs()[r].length, slab.end_node);
    }
  }
  EXPECT_EQ(run, static_cast<std::int32_t>(mesh.runs().size()));
}

}  // namespace
}  // namespace fascicle
