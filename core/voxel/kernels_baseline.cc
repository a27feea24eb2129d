#include "core/voxel/kernel_sets.h"
#include "core/voxel/kernels_impl.h"

namespace fascicle {

constinit const VoxelKernels kBaselineVoxelKernels = VoxelKernelsOf<BaselineSet>();

}  // namespace fascicle
