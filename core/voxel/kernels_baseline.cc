#include "core/voxel/kernel_sets.h"
#include "core/voxel/rotated_kernels_impl.h"

namespace fascicle {

constinit const VoxelKernels kBaselineVoxelKernels = VoxelKernelsOf<BaselineSet>();

}  // namespace fascicle
