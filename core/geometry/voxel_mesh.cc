#include "core/geometry/voxel_mesh.h"

#include <algorithm>

#include "core/base/check.h"

namespace fascicle {
namespace {

// Least number of voxels of a slab, and greatest number of slabs: enough slabs for several threads, but few planes of
// nodes shared by two slabs.
constexpr std::int32_t kSlabVoxels = 16384;
constexpr std::int32_t kMostSlabs = 32;

// The run that contains i among the runs [begin, end) of one row; null if none does.
template <class Run>
const Run* FindRun(const std::vector<Run>& runs, std::int32_t begin, std::int32_t end, std::int32_t i) {
  const auto after = std::upper_bound(runs.begin() + begin, runs.begin() + end, i,
                                      [](std::int32_t at, const Run& r) { return at < r.i; });
  if (after == runs.begin() + begin) return nullptr;
  const Run& run = *(after - 1);
  return i < run.i + run.length ? &run : nullptr;
}

}  // namespace

VoxelMesh::VoxelMesh(const VoxelGrid& grid) : size_(grid.size), spacing_(grid.spacing) {
  ForVoxels(grid, [&](std::size_t v, const GridIndex& at) {
    if (grid.material[v] != 0) AddRun(at, 1, grid.material[v]);
  });
  Finish();
}

void VoxelMesh::AddRun(const GridIndex& first, std::int32_t length, std::int32_t material) {
  if (!runs_.empty()) {
    VoxelRun& last = runs_.back();
    if (last.k == first[2] && last.j == first[1] && last.i + last.length == first[0] && last.material == material) {
      last.length += length;
      voxels_ += length;
      return;
    }
  }
  runs_.push_back({first[0], first[1], first[2], length, voxels_, material, {}});
  voxels_ += length;
}

void VoxelMesh::Finish() {
  runs_.shrink_to_fit();
  const std::size_t rows = static_cast<std::size_t>(size_[1]) * size_[2];
  row_begin_.assign(rows + 1, 0);
  for (const VoxelRun& run : runs_) ++row_begin_[run.j + static_cast<std::size_t>(size_[1]) * run.k + 1];
  for (std::size_t row = 0; row < rows; ++row) row_begin_[row + 1] += row_begin_[row];
  NumberNodes();
  for (VoxelRun& run : runs_) {
    for (int r = 0; r < 4; ++r) run.node[r] = NodeAt({run.i, run.j + (r & 1), run.k + (r >> 1)});
  }
  CutSlabs();
}

std::vector<VoxelMesh::Interval> VoxelMesh::VoxelIntervals(std::int32_t j, std::int32_t k) const {
  std::vector<Interval> intervals;
  if (j < 0 || k < 0 || j >= size_[1] || k >= size_[2]) return intervals;
  const std::size_t row = j + static_cast<std::size_t>(size_[1]) * k;
  for (std::int32_t r = row_begin_[row]; r < row_begin_[row + 1]; ++r) {
    intervals.push_back({runs_[r].i, runs_[r].i + runs_[r].length});
  }
  return intervals;
}

std::vector<VoxelMesh::Interval> VoxelMesh::Union(std::vector<Interval> intervals) {
  std::sort(intervals.begin(), intervals.end(), [](const Interval& a, const Interval& b) { return a.first < b.first; });
  std::vector<Interval> joined;
  for (const Interval& interval : intervals) {
    if (!joined.empty() && interval.first <= joined.back().end) {
      joined.back().end = std::max(joined.back().end, interval.end);
    } else {
      joined.push_back(interval);
    }
  }
  return joined;
}

std::vector<VoxelMesh::Interval> VoxelMesh::CoarseIntervals(std::int32_t j, std::int32_t k) const {
  std::vector<Interval> intervals;
  for (int r = 0; r < 4; ++r) {
    for (const Interval& fine : VoxelIntervals(2 * j + (r & 1), 2 * k + (r >> 1))) {
      intervals.push_back({fine.first / 2, (fine.end + 1) / 2});
    }
  }
  return Union(std::move(intervals));
}

void VoxelMesh::NumberNodes() {
  node_row_begin_.assign(1, 0);
  std::int64_t nodes = 0;
  for (std::int32_t k = 0; k <= size_[2]; ++k) {
    for (std::int32_t j = 0; j <= size_[1]; ++j) {
      std::vector<Interval> intervals;
      for (int r = 0; r < 4; ++r) {
        for (Interval interval : VoxelIntervals(j - (r & 1), k - (r >> 1))) {
          ++interval.end;  // a row of voxels has one more node than voxels
          intervals.push_back(interval);
        }
      }
      for (const Interval& interval : Union(std::move(intervals))) {
        node_runs_.push_back({interval.first, j, k, interval.end - interval.first, static_cast<std::int32_t>(nodes)});
        nodes += interval.end - interval.first;
      }
      node_row_begin_.push_back(static_cast<std::int32_t>(node_runs_.size()));
    }
  }
  FASCICLE_CHECK(nodes <= 700'000'000, "component indices must fit 31 bits");
  nodes_ = static_cast<std::int32_t>(nodes);
  node_runs_.shrink_to_fit();
}

void VoxelMesh::CutSlabs() {
  const std::int32_t least = std::max(kSlabVoxels, voxels_ / kMostSlabs);
  const auto first_node_of_plane = [&](std::int32_t k) {
    const std::int32_t run = NodeRunsOfPlane(k)[0];
    return run < static_cast<std::int32_t>(node_runs_.size()) ? node_runs_[run].first : nodes_;
  };
  VoxelSlab slab = {};
  for (std::int32_t k = 0; k < size_[2]; ++k) {
    slab.end_layer = k + 1;
    slab.end_run = row_begin_[static_cast<std::size_t>(size_[1]) * (k + 1)];
    const auto voxel_of_run = [&](std::int32_t r) {
      return r < static_cast<std::int32_t>(runs_.size()) ? runs_[r].first_voxel : voxels_;
    };
    if (voxel_of_run(slab.end_run) - voxel_of_run(slab.first_run) < least && k + 1 < size_[2]) continue;
    slab.first_node = first_node_of_plane(slab.first_layer);
    slab.end_node = k + 1 < size_[2] ? first_node_of_plane(k + 2) : nodes_;
    slabs_.push_back(slab);
    slab.first_layer = slab.end_layer;
    slab.first_run = slab.end_run;
  }
  for (std::size_t s = 0; s < slabs_.size(); ++s) {
    slabs_[s].first_inner = s == 0 ? 0 : slabs_[s - 1].end_node;
    slabs_[s].end_inner = s + 1 == slabs_.size() ? nodes_ : slabs_[s + 1].first_node;
  }
}

std::array<std::int32_t, 2> VoxelMesh::NodeRunsOfPlane(std::int32_t k) const {
  const std::size_t row = static_cast<std::size_t>(size_[1] + 1) * k;
  return {node_row_begin_[row], node_row_begin_[row + size_[1] + 1]};
}

const VoxelRun* VoxelMesh::RunAt(const GridIndex& at) const {
  if (at[1] < 0 || at[2] < 0 || at[1] >= size_[1] || at[2] >= size_[2]) return nullptr;
  const std::size_t row = at[1] + static_cast<std::size_t>(size_[1]) * at[2];
  return FindRun(runs_, row_begin_[row], row_begin_[row + 1], at[0]);
}

std::int32_t VoxelMesh::VoxelAt(const GridIndex& at) const {
  const VoxelRun* const run = RunAt(at);
  return run == nullptr ? -1 : run->first_voxel + at[0] - run->i;
}

std::int32_t VoxelMesh::NodeAt(const GridIndex& at) const {
  if (at[1] < 0 || at[2] < 0 || at[1] > size_[1] || at[2] > size_[2] || nodes_ == 0) return -1;
  const std::size_t row = at[1] + static_cast<std::size_t>(size_[1] + 1) * at[2];
  const NodeRun* const run = FindRun(node_runs_, node_row_begin_[row], node_row_begin_[row + 1], at[0]);
  return run == nullptr ? -1 : run->first + at[0] - run->i;
}

std::vector<GridIndex> VoxelMesh::NodePlaces() const {
  std::vector<GridIndex> places;
  places.reserve(nodes_);
  for (const NodeRun& run : node_runs_) {
    for (std::int32_t n = 0; n < run.length; ++n) places.push_back({run.i + n, run.j, run.k});
  }
  return places;
}

}  // namespace fascicle
