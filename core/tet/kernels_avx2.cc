#include "core/tet/kernel_sets.h"
#include "core/tet/kernels_impl.h"

namespace fascicle {

constinit const Kernels kAvx2Kernels = KernelsOf<Avx2Set>();

}  // namespace fascicle
