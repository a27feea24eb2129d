// The power fails while a store is written to: what was acknowledged is on the disk.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <random>

#include "acknowledged.h"
#include "tests/support/child_process.h"
#include "tests/support/files.h"
#include "tests/support/paths.h"

namespace fascicle::server {
namespace {

using testing::ChildProcess;
using testing::Finished;
using testing::Program;

int Cuts() {
  const char* number = std::getenv("FASCICLE_POWER_CUTS");
  return number != nullptr ? std::atoi(number) : 20;
}

class PowerLossTest : public ::testing::Test {
 protected:
  // Writes, fails, and returns what was acknowledged; `disk_` is what is left.
  Acknowledged WriteAndFail(int round, const char* syncs) {
    std::filesystem::remove_all(written_.path());
    const std::string delay = std::to_string(20'000 + random_() % 300'000);
    ChildProcess writer({Program("store_crash_writer"), written_.path(), std::to_string(round), disk_.path(), delay,
                         std::to_string(round), syncs});
    const Finished finished = writer.Wait();
    EXPECT_EQ(finished.exit_code, 0) << finished.err;
    Acknowledged acknowledged;
    acknowledged.Read(finished.out);
    return acknowledged;
  }

  testing::TemporaryFolder written_, disk_;
  std::mt19937 random_{7};
};

TEST_F(PowerLossTest, NothingAcknowledgedIsLost) {
  std::size_t jobs = 0, frames = 0;
  for (int round = 0; round < Cuts() && !HasFailure(); ++round) {
    const Acknowledged acknowledged = WriteAndFail(round, "honoured");
    const std::unique_ptr<Store> store = OpenSqliteStore(disk_.path());
    ExpectAll(*store, acknowledged);
    ExpectWhole(disk_ / "control.db");
    jobs += acknowledged.jobs.size();
    for (const auto& [number, count] : acknowledged.frames) frames += static_cast<std::size_t>(count);
  }
  std::cout << Cuts() << " power cuts, " << jobs << " jobs and " << frames << " frames acknowledged: 0 lost\n";
  EXPECT_GT(jobs, 0u);
}

// Without syncs, the same test finds losses: it can fail.
TEST_F(PowerLossTest, WithoutSyncsThereAreLosses) {
  int lost = 0;
  for (int round = 0; round < 8; ++round) {
    const Acknowledged acknowledged = WriteAndFail(round, "ignored");
    try {
      const std::unique_ptr<Store> store = OpenSqliteStore(disk_.path());
      for (const int number : acknowledged.jobs) {
        if (store->GetJob(SampleJob(number).id)) continue;
        ++lost;
        break;
      }
    } catch (const StoreError&) {
      ++lost;
    }
  }
  std::cout << lost << " of 8 power cuts without syncs lost something\n";
  EXPECT_GE(lost, 4);
}

}  // namespace
}  // namespace fascicle::server
