// The same bits in separate processes, for any number of threads that the environment gives to libraries, and with each
// instruction set of the kernels.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/instruction_set.h"
#include "tests/support/child_process.h"
#include "tests/support/paths.h"

namespace fascicle::testing {
namespace {

using Environment = std::map<std::string, std::string>;

std::string DigestsOf(const std::string& what, int threads, const Environment& environment) {
  const Finished finished = RunProgram({Program("print_digests"), what, std::to_string(threads)}, environment);
  EXPECT_EQ(finished.exit_code, 0) << finished.out << finished.err;
  return finished.out;
}

TEST(FreshProcessTest, DirectSolvesDoNotDependOnTheEnvironment) {
  const std::string first = DigestsOf("direct", 1, {});
  for (const char* name : {"definite ", "saddle ", "dynamic_voxels ", "quasi_static_muscle "}) {
    EXPECT_THAT(first, ::testing::HasSubstr(name));
  }
  const Environment environments[] = {
      {},
      {{"SCOTCH_PTHREAD_NUMBER", "1"}},
      {{"SCOTCH_PTHREAD_NUMBER", "4"}, {"SCOTCH_DETERMINISTIC", "0"}, {"SCOTCH_RANDOM_FIXED_SEED", "0"}},
      {{"OMP_NUM_THREADS", "4"}, {"OPENBLAS_NUM_THREADS", "4"}},
      {{"OMP_NUM_THREADS", "1"}, {"OPENBLAS_NUM_THREADS", "1"}, {"SCOTCH_PTHREAD_NUMBER", "-1"}}};
  for (std::size_t k = 0; k < std::size(environments); ++k) {
    EXPECT_EQ(DigestsOf("direct", 2 - static_cast<int>(k % 2), environments[k]), first) << "environment " << k;
  }
}

// The least and the best set of this machine; kernels are compared with all of them.
TEST(FreshProcessTest, AnyInstructionSet) {
  constexpr const char* kNames[] = {"baseline", "avx2", "avx512"};
  std::vector<InstructionSet> sets;
  for (const InstructionSet set : kInstructionSets) {
    if (!IsAvailable(set)) continue;
    if (sets.size() == 2) sets.pop_back();
    sets.push_back(set);
  }
  std::string first;
  for (const InstructionSet set : sets) {
    const auto number = static_cast<int>(set);
    const std::string digests = DigestsOf("small", 2, {{"FASCICLE_INSTRUCTION_SET", kNames[number]}});
    const std::string heading = "instruction set " + std::to_string(number) + '\n';
    ASSERT_THAT(digests, ::testing::StartsWith(heading));
    const std::string rest = digests.substr(heading.size());
    if (first.empty()) first = rest;
    EXPECT_EQ(rest, first) << kNames[number];
  }
  EXPECT_THAT(first, ::testing::HasSubstr("eulerian_implicit "));
}

}  // namespace
}  // namespace fascicle::testing
