#include "core/voxel/kernel_sets.h"
#include "core/voxel/kernels_impl.h"

namespace fascicle {

constinit const VoxelKernels kAvx2VoxelKernels = VoxelKernelsOf<Avx2Set>();

}  // namespace fascicle
