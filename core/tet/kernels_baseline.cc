#include "core/tet/kernel_sets.h"
#include "core/tet/kernels_impl.h"

namespace fascicle {

constinit const Kernels kBaselineKernels = KernelsOf<BaselineSet>();

}  // namespace fascicle
