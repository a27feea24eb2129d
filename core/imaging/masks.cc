#include "core/imaging/masks.h"

#include <algorithm>
#include <map>

#include "core/imaging/itk_filters.h"

namespace fascicle {
namespace {

std::vector<std::uint8_t> Marked(const VoxelGrid& grid, bool solid) {
  std::vector<std::uint8_t> marked(grid.voxels());
  for (std::size_t v = 0; v < marked.size(); ++v) marked[v] = (grid.material[v] != 0) == solid ? 1 : 0;
  return marked;
}

bool AnyOf(const std::vector<std::uint8_t>& marked) {
  return std::find(marked.begin(), marked.end(), 1) != marked.end();
}

// Distances of voxels on the same lattice are sums of squares, rounded.
constexpr double kRounding = 1 + 1e-6;

}  // namespace

void Erode(VoxelGrid& grid, double radius, ThreadTeam& team) {
  const std::vector<std::uint8_t> empty = Marked(grid, false);
  if (radius <= 0 || !AnyOf(empty)) return;
  const std::vector<float> distances = DistancesTo(empty, grid.size, grid.spacing, team.size());
  for (std::size_t v = 0; v < distances.size(); ++v) {
    if (distances[v] <= radius * kRounding) grid.material[v] = 0;
  }
}

void Restore(VoxelGrid& grid, const VoxelGrid& whole, double radius, ThreadTeam& team) {
  const std::vector<std::uint8_t> solid = Marked(grid, true);
  if (radius <= 0 || !AnyOf(solid)) return;
  const std::vector<float> distances = DistancesTo(solid, grid.size, grid.spacing, team.size());
  for (std::size_t v = 0; v < distances.size(); ++v) {
    if (distances[v] <= radius * kRounding) grid.material[v] = whole.material[v];
  }
}

void KeepIslandsOf(VoxelGrid& grid, const std::vector<GridIndex>& seeds) {
  const Islands islands = FindIslands(grid);
  std::vector<bool> kept(islands.voxels.size(), false);
  for (const GridIndex& seed : seeds) kept[islands.island[grid.IndexOf(seed)]] = true;
  for (std::size_t v = 0; v < grid.voxels(); ++v) {
    if (islands.island[v] >= 0 && !kept[islands.island[v]]) grid.material[v] = 0;
  }
}

void FillHoles(VoxelGrid& grid) {
  VoxelGrid empty = grid;
  empty.material = Marked(grid, false);
  const Islands islands = FindIslands(empty);
  std::vector<bool> open(islands.voxels.size(), false);
  std::vector<std::map<std::uint8_t, std::int64_t>> around(islands.voxels.size());  // faces of each material
  ForVoxels(grid, [&](std::size_t v, const GridIndex& at) {
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
  });
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
