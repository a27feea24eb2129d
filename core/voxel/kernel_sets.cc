#include "core/voxel/kernel_sets.h"

#include "core/base/check.h"

namespace fascicle {

const VoxelKernels& VoxelKernelsFor(InstructionSet set) {
  FASCICLE_CHECK(IsAvailable(set), "this machine lacks the kernels' instruction set");
#if defined(__x86_64__) && !defined(FASCICLE_BASELINE_KERNELS)
  if (set == InstructionSet::kAvx2) return kAvx2VoxelKernels;
  if (set == InstructionSet::kAvx512) return kAvx512VoxelKernels;
#endif
  return kBaselineVoxelKernels;
}

}  // namespace fascicle
