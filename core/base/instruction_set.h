#ifndef FASCICLE_CORE_BASE_INSTRUCTION_SET_H_
#define FASCICLE_CORE_BASE_INSTRUCTION_SET_H_

namespace fascicle {

// What kernels are compiled for; see lanes.h.
enum class InstructionSet { kBaseline, kAvx2, kAvx512 };
inline constexpr InstructionSet kInstructionSets[] = {InstructionSet::kBaseline, InstructionSet::kAvx2,
                                                      InstructionSet::kAvx512};

// Whether this build and this machine have it.
bool IsAvailable(InstructionSet set);
// The widest one there is, or what the environment variable FASCICLE_INSTRUCTION_SET says (baseline, avx2, avx512) if
// that is available. Results are the same bits with each.
InstructionSet PreferredInstructionSet();

}  // namespace fascicle

#endif  // FASCICLE_CORE_BASE_INSTRUCTION_SET_H_
