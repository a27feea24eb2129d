#include "core/base/instruction_set.h"

#include <cstdlib>
#include <string_view>

namespace fascicle {
namespace {

constexpr std::string_view kNames[] = {"baseline", "avx2", "avx512"};

InstructionSet FindPreferred() {
  InstructionSet widest = InstructionSet::kBaseline;
  const char* const wanted = std::getenv("FASCICLE_INSTRUCTION_SET");
  for (const InstructionSet set : kInstructionSets) {
    if (!IsAvailable(set)) continue;
    if (wanted != nullptr && wanted == kNames[static_cast<int>(set)]) return set;
    widest = set;
  }
  return widest;
}

}  // namespace

bool IsAvailable(InstructionSet set) {
#if defined(__x86_64__) && !defined(FASCICLE_BASELINE_KERNELS)
  switch (set) {
    case InstructionSet::kAvx2:
      return __builtin_cpu_supports("avx2");
    case InstructionSet::kAvx512:
      return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
             __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw");
    case InstructionSet::kBaseline:
      break;
  }
#endif
  return set == InstructionSet::kBaseline;
}

InstructionSet PreferredInstructionSet() {
  static const InstructionSet preferred = FindPreferred();
  return preferred;
}

}  // namespace fascicle
