#ifndef FASCICLE_CORE_GEOMETRY_VOXEL_GRID_H_
#define FASCICLE_CORE_GEOMETRY_VOXEL_GRID_H_

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/types.h"

namespace fascicle {

// A place in a grid, or in the lattice of its corners: i, j, k from 0.
using GridIndex = std::array<std::int32_t, 3>;

// A box of voxels, some of them solid. Plain data.
struct VoxelGrid {
  GridIndex size = {0, 0, 0};   // voxels along i, j, k
  Vec3 spacing = Vec3::Ones();  // of a voxel [m]
  // Corner (i, j, k) is at origin + direction * (spacing times (i, j, k)) [m]. (Images give the centre of the first
  // voxel, half a voxel further.)
  Vec3 origin = Vec3::Zero();
  Mat3 direction = Mat3::Identity();  // columns: unit vectors along i, j, k
  // Of each voxel, i fastest, then j: 0 where it is empty, m where it is of the m-th material.
  std::vector<std::uint8_t> material;
  // Factor of each voxel's Young's modulus [1], > 0 where it is solid; empty for 1 everywhere.
  std::vector<float> stiffness;

  std::size_t voxels() const { return static_cast<std::size_t>(size[0]) * size[1] * size[2]; }
  std::size_t IndexOf(const GridIndex& at) const {
    return static_cast<std::size_t>(at[0]) +
           static_cast<std::size_t>(size[0]) * (at[1] + static_cast<std::size_t>(size[1]) * at[2]);
  }
  bool Contains(const GridIndex& at) const {
    return at[0] >= 0 && at[1] >= 0 && at[2] >= 0 && at[0] < size[0] && at[1] < size[1] && at[2] < size[2];
  }
  // 0 outside of the box.
  std::uint8_t MaterialAt(const GridIndex& at) const { return Contains(at) ? material[IndexOf(at)] : 0; }
  Vec3 CornerAt(const GridIndex& at) const {
    return origin + direction * spacing.cwiseProduct(Vec3(at[0], at[1], at[2]));
  }
};

// An empty grid of that size; size >= 0, at most 2^31 - 1 voxels.
VoxelGrid MakeVoxelGrid(const GridIndex& size, const Vec3& spacing);

// Calls body(index of the voxel, its place) for all voxels, i fastest.
template <class Body>
void ForVoxels(const VoxelGrid& grid, const Body& body) {
  std::size_t v = 0;
  for (std::int32_t k = 0; k < grid.size[2]; ++k) {
    for (std::int32_t j = 0; j < grid.size[1]; ++j) {
      for (std::int32_t i = 0; i < grid.size[0]; ++i) body(v++, GridIndex{i, j, k});
    }
  }
}

// Joins 2x2x2 voxels [Zhu, Chen & Kaufman 1998, 3]: a voxel of twice the spacing is solid where at least `fraction`, in
// (0, 1], of its eight are, of the material that most of these have (of several, the first), and as stiff as the solid
// ones are on average. A box of odd size is filled up by empty voxels; origin and direction stay.
VoxelGrid Coarsen(const VoxelGrid& grid, double fraction);

// The smallest box that holds all solid voxels; its origin moves along. An empty grid becomes one of size 0.
VoxelGrid CropToSolid(const VoxelGrid& grid);

// Parts of a grid that hang together by faces of voxels.
struct Islands {
  std::vector<std::int32_t> island;  // of each voxel, -1 where it is empty; counted from the first voxel on
  std::vector<std::int64_t> voxels;  // of each island
};
Islands FindIslands(const VoxelGrid& grid);

// Empties all voxels but those of the largest island (of several, the first).
void KeepLargestIsland(VoxelGrid& grid);

// A row of the table of a hierarchy, as [Zhu et al. 1998, Table 1].
struct VoxelLevel {
  std::int32_t voxel_size = 1;  // in voxels of the finest level
  VoxelGrid grid;
  std::int64_t voxels = 0, nodes = 0;  // solid voxels, and corners of these
};

// The grid and its coarser levels, each made of the one before, as long as these have solid voxels and at most `levels`
// of them.
std::vector<VoxelLevel> MakeHierarchy(const VoxelGrid& grid, double fraction, int levels);

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_VOXEL_GRID_H_
