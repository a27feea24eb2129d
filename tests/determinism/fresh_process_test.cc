// Direct solves above 10,000 unknowns have the same bits in every process, whatever threads its environment allows to
// the libraries below.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/child_process.h"
#include "tests/support/paths.h"

namespace fascicle::testing {
namespace {

TEST(FreshProcessTest, DirectSolvesHaveTheSameBits) {
  const std::map<std::string, std::string> environments[] = {
      {},
      {},
      {{"SCOTCH_PTHREAD_NUMBER", "1"}},
      {{"SCOTCH_PTHREAD_NUMBER", "4"}, {"SCOTCH_DETERMINISTIC", "0"}, {"SCOTCH_RANDOM_FIXED_SEED", "0"}},
      {{"OMP_NUM_THREADS", "4"}, {"OPENBLAS_NUM_THREADS", "4"}},
      {{"OMP_NUM_THREADS", "1"}, {"OPENBLAS_NUM_THREADS", "1"}, {"SCOTCH_PTHREAD_NUMBER", "-1"}}};
  std::string first;
  for (std::size_t k = 0; k < std::size(environments); ++k) {
    const Finished finished = RunProgram({Program("direct_solve_digests"), k % 2 == 0 ? "1" : "2"}, environments[k]);
    ASSERT_EQ(finished.exit_code, 0) << finished.out << finished.err;
    if (k == 0) first = finished.out;
    EXPECT_EQ(finished.out, first) << "environment " << k;
  }
  for (const char* name : {"definite ", "saddle ", "dynamic_voxels ", "quasi_static_muscle "}) {
    EXPECT_THAT(first, ::testing::HasSubstr(name));
  }
}

}  // namespace
}  // namespace fascicle::testing
