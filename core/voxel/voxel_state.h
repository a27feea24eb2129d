#ifndef FASCICLE_CORE_VOXEL_VOXEL_STATE_H_
#define FASCICLE_CORE_VOXEL_VOXEL_STATE_H_

#include <cstdint>

#include "core/base/archive.h"
#include "core/voxel/voxel_field.h"

namespace fascicle {

// Everything that changes from step to step, which is what a checkpoint saves.
struct VoxelState {
  double time = 0;  // [s]
  std::int64_t step = 0;
  VoxelField<double> displacement;  // u_n, at `time` [m]
  VoxelField<double> previous;      // u_{n-1}, one step earlier [m]
  std::int64_t iterations = 0;      // of linear solves so far

  void Save(ArchiveWriter& archive) const;
  // Sets failed() of the archive if sizes differ from the current ones.
  void Load(ArchiveReader& archive);
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_VOXEL_VOXEL_STATE_H_
