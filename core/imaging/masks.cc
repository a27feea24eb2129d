#include "core/imaging/masks.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>

namespace fascicle {
namespace {

std::vector<std::uint8_t> Marked(const VoxelGrid& grid, bool solid) {
  std::vector<std::uint8_t> marked(grid.voxels());
  for (std::size_t v = 0; v < marked.size(); ++v) marked[v] = (grid.material[v] != 0) == solid ? 1 : 0;
  return marked;
}

// Squared distances are sums of rounded squares.
constexpr double kRounding = 1 + 1e-9;

// The voxels whose centres are within `radius` [m] of that of a marked voxel. Works axis by axis: first the squared
// distance to the nearest marked voxel along i, then the minimum of these plus the squared offset along j, then along
// k; never beyond the radius.
std::vector<std::uint8_t> Within(const std::vector<std::uint8_t>& marked, const VoxelGrid& grid, double radius,
                                 ThreadTeam& team) {
  const double far = 4 * radius * radius + 1;
  std::vector<double> squares(marked.size()), next(marked.size());
  for (std::size_t v = 0; v < marked.size(); ++v) squares[v] = marked[v] != 0 ? 0 : far;
  std::size_t stride = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const std::int32_t size = grid.size[axis];
    const double spacing = grid.spacing[axis];
    const auto reach = static_cast<std::int32_t>(std::min<double>(size - 1, std::floor(radius * kRounding / spacing)));
    ForEach(team, marked.size(), 4096, [&](std::size_t v) {
      const auto at = static_cast<std::int32_t>(v / stride % size);
      double least = squares[v];
      for (std::int32_t d = std::max(-reach, -at); d <= std::min(reach, size - 1 - at); ++d) {
        const double way = d * spacing;
        least = std::min(least, squares[v + static_cast<std::ptrdiff_t>(stride) * d] + way * way);
      }
      next[v] = least;
    });
    squares.swap(next);
    stride *= size;
  }
  std::vector<std::uint8_t> within(marked.size());
  const double limit = radius * radius * kRounding;
  for (std::size_t v = 0; v < marked.size(); ++v) within[v] = squares[v] <= limit ? 1 : 0;
  return within;
}

}  // namespace

void Erode(VoxelGrid& grid, double radius, ThreadTeam& team) {
  if (radius <= 0) return;
  const std::vector<std::uint8_t> near = Within(Marked(grid, false), grid, radius, team);
  for (std::size_t v = 0; v < near.size(); ++v) {
    if (near[v] != 0) grid.material[v] = 0;
  }
}

void Restore(VoxelGrid& grid, const VoxelGrid& whole, double radius, ThreadTeam& team) {
  if (radius <= 0) return;
  const std::vector<std::uint8_t> near = Within(Marked(grid, true), grid, radius, team);
  for (std::size_t v = 0; v < near.size(); ++v) {
    if (near[v] != 0) grid.material[v] = whole.material[v];
  }
}

void KeepIslandsOf(VoxelGrid& grid, const std::vector<GridIndex>& seeds, const std::stop_token& stop) {
  const Islands islands = FindIslands(grid, stop);
  std::vector<bool> kept(islands.voxels.size(), false);
  for (const GridIndex& seed : seeds) kept[islands.island[grid.IndexOf(seed)]] = true;
  for (std::size_t v = 0; v < grid.voxels(); ++v) {
    if (islands.island[v] >= 0 && !kept[islands.island[v]]) grid.material[v] = 0;
  }
}

void FillHoles(VoxelGrid& grid, const std::stop_token& stop) {
  VoxelGrid empty = grid;
  empty.material = Marked(grid, false);
  const Islands islands = FindIslands(empty, stop);
  std::vector<bool> open(islands.voxels.size(), false);
  std::vector<std::map<std::uint8_t, std::int64_t>> around(
      islands.voxels.size());  // number of faces with each material
  const auto look_around = [&](std::size_t v, const GridIndex& at) {
    const std::int32_t island = islands.island[v];
    if (island < 0) return;
    for (int side = 0; side < 6; ++side) {
      GridIndex next = at;
      next[side / 2] += side % 2 == 0 ? -1 : 1;
      if (!grid.Contains(next)) {
        open[island] = true;
      } else if (const std::uint8_t material = grid.MaterialAt(next); material != 0) {
        ++around[island][material];
      }
    }
  };
  ForVoxels(grid, look_around, stop);
  std::vector<std::uint8_t> filling(islands.voxels.size(), 0);
  for (std::size_t h = 0; h < filling.size(); ++h) {
    if (open[h]) continue;
    const auto fewer = [](const auto& a, const auto& b) { return a.second < b.second; };
    filling[h] = std::max_element(around[h].begin(), around[h].end(), fewer)->first;
  }
  for (std::size_t v = 0; v < grid.voxels(); ++v) {
    if (islands.island[v] >= 0) grid.material[v] = filling[islands.island[v]];
  }
}

double DiceOverlap(const VoxelGrid& a, const VoxelGrid& b) {
  std::int64_t both = 0, sum = 0;
  for (std::size_t v = 0; v < a.voxels(); ++v) {
    const bool in_a = a.material[v] != 0, in_b = b.material[v] != 0;
    both += in_a && in_b ? 1 : 0;
    sum += (in_a ? 1 : 0) + (in_b ? 1 : 0);
  }
  return sum == 0 ? 1 : 2 * static_cast<double>(both) / static_cast<double>(sum);
}

}  // namespace fascicle
