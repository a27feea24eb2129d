#ifndef FASCICLE_CORE_BASE_INSTRUCTION_SET_H_
#define FASCICLE_CORE_BASE_INSTRUCTION_SET_H_

namespace fascicle {

// Instruction sets that kernels are compiled for (see lanes.h).
enum class InstructionSet { kBaseline, kAvx2, kAvx512 };
inline constexpr InstructionSet kInstructionSets[] = {InstructionSet::kBaseline, InstructionSet::kAvx2,
                                                      InstructionSet::kAvx512};

// Whether both this build and this machine support the set.
bool IsAvailable(InstructionSet set);
// The widest available set. The environment variable FASCICLE_INSTRUCTION_SET (baseline, avx2, avx512) overrides it
// with another available one. Results have the same bits with every set.
InstructionSet PreferredInstructionSet();

}  // namespace fascicle

#endif  // FASCICLE_CORE_BASE_INSTRUCTION_SET_H_
