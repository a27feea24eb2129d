#ifndef FASCICLE_TESTS_FAULTS_CRASH_SAMPLES_H_
#define FASCICLE_TESTS_FAULTS_CRASH_SAMPLES_H_

#include <cstdint>
#include <string>

#include "tests/support/store_samples.h"

namespace fascicle::server {

constexpr int kJobsPerRound = 2000;  // the first has frames

// Small ones, and some of several chunks.
inline SampleFrame CrashFrame(int job, std::int64_t index) {
  const auto size = static_cast<std::size_t>(index % 7 == 3 ? 1'200'000 : 1'000 + 37 * index);
  return MakeSampleFrame(index, size, static_cast<std::uint64_t>(job) + 1);
}

// Of every third frame.
inline std::string CrashCheckpoint(int job, std::int64_t index) {
  if (index % 3 != 0) return {};
  return std::to_string(job) + "/" + std::to_string(index) + "/" +
         SampleBytes(static_cast<std::uint64_t>(index) + 1, 5000);
}

}  // namespace fascicle::server

#endif  // FASCICLE_TESTS_FAULTS_CRASH_SAMPLES_H_
