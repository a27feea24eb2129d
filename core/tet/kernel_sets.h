#ifndef FASCICLE_CORE_TET_KERNEL_SETS_H_
#define FASCICLE_CORE_TET_KERNEL_SETS_H_

#include "core/tet/kernels.h"

// The kernels for each instruction set, one file each.
namespace fascicle {

extern const Kernels kBaselineKernels;
#if defined(__x86_64__) && !defined(FASCICLE_BASELINE_KERNELS)
extern const Kernels kAvx2Kernels;
extern const Kernels kAvx512Kernels;
#endif

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_KERNEL_SETS_H_
