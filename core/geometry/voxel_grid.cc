#include "core/geometry/voxel_grid.h"

#include <algorithm>
#include <limits>

#include "core/base/check.h"
#include "core/geometry/voxel_mesh.h"

namespace fascicle {
namespace {

// The coarse voxel made of eight fine ones.
struct Joined {
  std::uint8_t material = 0;
  float stiffness = 0;
  int solid = 0;
};

Joined Join(const VoxelGrid& grid, const GridIndex& coarse) {
  Joined joined;
  std::array<std::uint8_t, 8> materials = {};
  for (int c = 0; c < 8; ++c) {
    const GridIndex at = {2 * coarse[0] + (c & 1), 2 * coarse[1] + (c >> 1 & 1), 2 * coarse[2] + (c >> 2)};
    const std::uint8_t material = grid.MaterialAt(at);
    if (material == 0) continue;
    materials[joined.solid++] = material;
    joined.stiffness += grid.stiffness.empty() ? 1 : grid.stiffness[grid.IndexOf(at)];
  }
  if (joined.solid == 0) return joined;
  joined.stiffness /= static_cast<float>(joined.solid);
  const auto end = materials.begin() + joined.solid;
  std::sort(materials.begin(), end);
  std::ptrdiff_t most = 0;
  for (auto first = materials.begin(); first != end;) {
    const auto next = std::upper_bound(first, end, *first);
    if (next - first > most) {
      most = next - first;
      joined.material = *first;
    }
    first = next;
  }
  return joined;
}

}  // namespace

VoxelGrid MakeVoxelGrid(const GridIndex& size, const Vec3& spacing) {
  VoxelGrid grid;
  grid.size = size;
  grid.spacing = spacing;
  const double voxels = static_cast<double>(size[0]) * size[1] * size[2];
  FASCICLE_CHECK(size[0] >= 0 && size[1] >= 0 && size[2] >= 0 && voxels <= std::numeric_limits<std::int32_t>::max(),
                 "the size of a grid was not checked");
  grid.material.assign(grid.voxels(), 0);
  return grid;
}

VoxelGrid Coarsen(const VoxelGrid& grid, double fraction, const std::stop_token& stop) {
  VoxelGrid coarse =
      MakeVoxelGrid({(grid.size[0] + 1) / 2, (grid.size[1] + 1) / 2, (grid.size[2] + 1) / 2}, 2 * grid.spacing);
  coarse.origin = grid.origin;
  coarse.direction = grid.direction;
  if (!grid.stiffness.empty()) coarse.stiffness.assign(coarse.voxels(), 0);
  const auto join = [&](std::size_t v, const GridIndex& at) {
    const Joined joined = Join(grid, at);
    if (joined.solid == 0 || joined.solid < 8 * fraction) return;
    coarse.material[v] = joined.material;
    if (!coarse.stiffness.empty()) coarse.stiffness[v] = joined.stiffness;
  };
  ForVoxels(coarse, join, stop);
  return coarse;
}

VoxelGrid CropToSolid(const VoxelGrid& grid, const std::stop_token& stop) {
  GridIndex low = grid.size, high = {0, 0, 0};
  const auto include = [&](std::size_t v, const GridIndex& at) {
    if (grid.material[v] == 0) return;
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], at[axis]);
      high[axis] = std::max(high[axis], at[axis] + 1);
    }
  };
  ForVoxels(grid, include, stop);
  if (high[0] == 0) low = {0, 0, 0};
  VoxelGrid cropped = MakeVoxelGrid({high[0] - low[0], high[1] - low[1], high[2] - low[2]}, grid.spacing);
  cropped.origin = grid.CornerAt(low);
  cropped.direction = grid.direction;
  if (!grid.stiffness.empty()) cropped.stiffness.assign(cropped.voxels(), 0);
  const auto copy = [&](std::size_t v, const GridIndex& at) {
    const std::size_t from = grid.IndexOf({at[0] + low[0], at[1] + low[1], at[2] + low[2]});
    cropped.material[v] = grid.material[from];
    if (!cropped.stiffness.empty()) cropped.stiffness[v] = grid.stiffness[from];
  };
  ForVoxels(cropped, copy, stop);
  return cropped;
}

Islands FindIslands(const VoxelGrid& grid, const std::stop_token& stop) {
  Islands islands;
  islands.island.assign(grid.voxels(), -1);
  std::vector<GridIndex> front;
  const auto fill = [&](std::size_t seed, const GridIndex& at) {
    if (grid.material[seed] == 0 || islands.island[seed] >= 0) return;
    const auto number = static_cast<std::int32_t>(islands.voxels.size());
    std::int64_t count = 0;
    islands.island[seed] = number;
    front.assign(1, at);
    while (!front.empty()) {
      ThrowIfStopped(stop);
      const GridIndex here = front.back();
      front.pop_back();
      ++count;
      for (int side = 0; side < 6; ++side) {
        GridIndex next = here;
        next[side / 2] += side % 2 == 0 ? -1 : 1;
        if (grid.MaterialAt(next) == 0) continue;
        std::int32_t& island = islands.island[grid.IndexOf(next)];
        if (island >= 0) continue;
        island = number;
        front.push_back(next);
      }
    }
    islands.voxels.push_back(count);
  };
  ForVoxels(grid, fill, stop);
  return islands;
}

void KeepLargestIsland(VoxelGrid& grid, const std::stop_token& stop) {
  const Islands islands = FindIslands(grid, stop);
  const auto largest = std::max_element(islands.voxels.begin(), islands.voxels.end()) - islands.voxels.begin();
  for (std::size_t v = 0; v < grid.voxels(); ++v) {
    if (islands.island[v] != largest) grid.material[v] = 0;
  }
}

std::vector<VoxelLevel> MakeHierarchy(const VoxelGrid& grid, double fraction, int levels, const std::stop_token& stop) {
  std::vector<VoxelLevel> hierarchy;
  for (int l = 0; l < levels; ++l) {
    VoxelLevel level;
    level.voxel_size = std::int32_t{1} << l;
    level.grid = l == 0 ? grid : Coarsen(hierarchy.back().grid, fraction, stop);
    const VoxelMesh mesh(level.grid);
    if (mesh.voxels() == 0) break;
    level.voxels = mesh.voxels();
    level.nodes = mesh.nodes();
    hierarchy.push_back(std::move(level));
  }
  return hierarchy;
}

}  // namespace fascicle
