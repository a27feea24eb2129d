#include "core/tet/kernel_sets.h"

#include "core/base/check.h"

namespace fascicle {

const Kernels& KernelsFor(InstructionSet set) {
  FASCICLE_CHECK(IsAvailable(set), "this machine lacks the kernels' instruction set");
#if defined(__x86_64__) && !defined(FASCICLE_BASELINE_KERNELS)
  if (set == InstructionSet::kAvx2) return kAvx2Kernels;
  if (set == InstructionSet::kAvx512) return kAvx512Kernels;
#endif
  return kBaselineKernels;
}

}  // namespace fascicle
