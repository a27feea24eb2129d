#ifndef FASCICLE_CORE_VOXEL_KERNEL_SETS_H_
#define FASCICLE_CORE_VOXEL_KERNEL_SETS_H_

#include "core/voxel/kernels.h"

// The kernels for each instruction set, one file each.
namespace fascicle {

extern const VoxelKernels kBaselineVoxelKernels;
#if defined(__x86_64__) && !defined(FASCICLE_BASELINE_KERNELS)
extern const VoxelKernels kAvx2VoxelKernels;
extern const VoxelKernels kAvx512VoxelKernels;
#endif

}  // namespace fascicle

#endif  // FASCICLE_CORE_VOXEL_KERNEL_SETS_H_
