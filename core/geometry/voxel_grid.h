#ifndef FASCICLE_CORE_GEOMETRY_VOXEL_GRID_H_
#define FASCICLE_CORE_GEOMETRY_VOXEL_GRID_H_

#include <array>
#include <cstdint>
#include <stop_token>
#include <vector>

#include "core/base/stop.h"
#include "core/base/types.h"

namespace fascicle {

// An index (i, j, k), counted from 0, of a voxel in a grid or of a corner in its lattice.
using GridIndex = std::array<std::int32_t, 3>;

// A box of voxels, some of which are solid. Plain data.
struct VoxelGrid {
  GridIndex size = {0, 0, 0};   // voxels along i, j, k
  Vec3 spacing = Vec3::Ones();  // edge lengths of a voxel [m]
  // Corner (i, j, k) is at origin + direction * (spacing times (i, j, k)) [m]. Image formats give the centre of the
  // first voxel instead, which is half a voxel further.
  Vec3 origin = Vec3::Zero();
  Mat3 direction = Mat3::Identity();  // columns: unit vectors along i, j, k
  // Material of each voxel, i fastest, then j: 0 if it is empty, otherwise counted from 1.
  std::vector<std::uint8_t> material;
  // Factor of each solid voxel's Young's modulus [1], > 0; empty: 1 everywhere.
  std::vector<float> stiffness;

  std::size_t voxels() const { return static_cast<std::size_t>(size[0]) * size[1] * size[2]; }
  std::size_t IndexOf(const GridIndex& at) const {
    return static_cast<std::size_t>(at[0]) +
           static_cast<std::size_t>(size[0]) * (at[1] + static_cast<std::size_t>(size[1]) * at[2]);
  }
  bool Contains(const GridIndex& at) const {
    return at[0] >= 0 && at[1] >= 0 && at[2] >= 0 && at[0] < size[0] && at[1] < size[1] && at[2] < size[2];
  }
  // 0 outside of the grid.
  std::uint8_t MaterialAt(const GridIndex& at) const { return Contains(at) ? material[IndexOf(at)] : 0; }
  Vec3 CornerAt(const GridIndex& at) const {
    return origin + direction * spacing.cwiseProduct(Vec3(at[0], at[1], at[2]));
  }
};

// An empty grid of the given size (>= 0, at most 2^31 - 1 voxels).
VoxelGrid MakeVoxelGrid(const GridIndex& size, const Vec3& spacing);

// Functions that take a stop token throw Stopped after a stop request.

// Calls body(voxel index, grid index) for all voxels, i fastest.
template <class Body>
void ForVoxels(const VoxelGrid& grid, const Body& body, const std::stop_token& stop = {}) {
  std::size_t v = 0;
  for (std::int32_t k = 0; k < grid.size[2]; ++k) {
    for (std::int32_t j = 0; j < grid.size[1]; ++j) {
      ThrowIfStopped(stop);
      for (std::int32_t i = 0; i < grid.size[0]; ++i) body(v++, GridIndex{i, j, k});
    }
  }
}

// Joins 2x2x2 voxels [Zhu, Chen & Kaufman 1998, 4]. A coarse voxel is solid if at least `fraction`, in (0, 1], of its
// eight fine voxels are. It has the most frequent material of its solid voxels (the lowest number on a tie) and their
// mean stiffness. A grid of odd size is padded with empty voxels. Origin and direction are unchanged.
VoxelGrid Coarsen(const VoxelGrid& grid, double fraction, const std::stop_token& stop = {});

// Crops to the bounding box of the solid voxels and moves the origin accordingly. An empty grid becomes one of size 0.
VoxelGrid CropToSolid(const VoxelGrid& grid, const std::stop_token& stop = {});

// Islands: face-connected components of the solid voxels.
struct Islands {
  std::vector<std::int32_t> island;  // of each voxel; -1 if it is empty; numbered in the order of their first voxels
  std::vector<std::int64_t> voxels;  // number of voxels of each island
};
Islands FindIslands(const VoxelGrid& grid, const std::stop_token& stop = {});

// Empties all voxels outside of the largest island (the first of equally large ones).
void KeepLargestIsland(VoxelGrid& grid, const std::stop_token& stop = {});

// A row of the table of a hierarchy [Zhu et al. 1998, Table 1].
struct VoxelLevel {
  std::int32_t voxel_size = 1;  // relative to voxels of the finest level
  VoxelGrid grid;
  std::int64_t voxels = 0, nodes = 0;  // numbers of solid voxels and of their corners
};

// The grid followed by its coarser levels, each coarsened from the one before: at most `levels` in all, as long as they
// have solid voxels.
std::vector<VoxelLevel> MakeHierarchy(const VoxelGrid& grid, double fraction, int levels,
                                      const std::stop_token& stop = {});

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_VOXEL_GRID_H_
