#include "core/voxel/transfer.h"

#include <algorithm>

#include "core/base/check.h"

namespace fascicle {
namespace {

// The consecutive coarse nodes of a row; the fine run's first node is at or after the first of them.
TransferRun RunOf(const NodeRun& fine, const VoxelMesh& coarse) {
  TransferRun run = {fine.first, fine.length, fine.i % 2, 0, {}};
  for (int far = 0; far <= fine.k % 2; ++far) {
    for (int side = 0; side <= fine.j % 2; ++side) {
      const std::int32_t node = coarse.NodeAt({fine.i / 2, fine.j / 2 + side, fine.k / 2 + far});
      FASCICLE_CHECK(node >= 0, "a fine voxel outside of the coarse mesh");
      run.coarse[run.rows++] = node;
    }
  }
  return run;
}

}  // namespace

VoxelTransfer::VoxelTransfer(const VoxelMesh& fine, const VoxelMesh& coarse, const VoxelKernels* kernels)
    : coarse_(&coarse), kernels_(kernels) {
  runs_.reserve(fine.node_runs().size());
  for (const NodeRun& run : fine.node_runs()) runs_.push_back(RunOf(run, coarse));
  // Coarse layer k has the fine planes 2k and 2k + 1; the last layer also has the plane at its end.
  for (const VoxelSlab& slab : coarse.slabs()) {
    slab_begin_.push_back(fine.NodeRunsOfPlane(std::min(2 * slab.first_layer, fine.size()[2]))[0]);
  }
  slab_begin_.push_back(static_cast<std::int32_t>(runs_.size()));
}

void VoxelTransfer::Interpolate(const VoxelField<float>& coarse, ThreadTeam& team, VoxelField<float>& fine) const {
  team.For(runs_.size(), 256, [&](std::size_t begin, std::size_t end) {
    const std::int32_t first = runs_[begin].first, last = runs_[end - 1].first + runs_[end - 1].length;
    TransferTask task;
    task.runs = runs_.data() + begin;
    task.run_count = static_cast<std::int32_t>(end - begin);
    for (int d = 0; d < 3; ++d) {
      std::fill(fine.component(d) + first, fine.component(d) + last, 0.0f);
      task.from[d] = coarse.component(d);
      task.to[d] = fine.component(d);
    }
    kernels_->interpolate(task);
  });
}

void VoxelTransfer::Transpose(const VoxelField<float>& fine, ThreadTeam& team, VoxelField<float>& coarse) const {
  ForSlabs(*coarse_, team, [&](std::size_t s) {
    ClearSlab(*coarse_, s, coarse);
    TransferTask task;
    task.runs = runs_.data() + slab_begin_[s];
    task.run_count = slab_begin_[s + 1] - slab_begin_[s];
    for (int d = 0; d < 3; ++d) {
      task.from[d] = fine.component(d);
      task.to[d] = coarse.component(d);
    }
    kernels_->interpolate_transposed(task);
  });
}

}  // namespace fascicle
