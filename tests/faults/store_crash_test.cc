// Kills a writing process at random times: everything that the store has acknowledged exists with the same bits, and
// the store opens quickly and complete. (The kernel survives, so this tests the order of commits and acknowledgements,
// not fsync.)
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <map>
#include <random>
#include <set>
#include <sstream>
#include <thread>

#include "acknowledged.h"
#include "crash_samples.h"
#include "server/store/database.h"
#include "server/store/store.h"
#include "tests/support/child_process.h"
#include "tests/support/files.h"
#include "tests/support/paths.h"
#include "tests/support/store_samples.h"

namespace fascicle::server {
namespace {

using testing::ChildProcess;
using testing::Finished;
using testing::Program;

constexpr int kRounds = 50;

// Runs the writer, kills it `delay` after its first report, and returns all its reports.
std::string RunAndKill(const std::string& directory, int round, std::chrono::microseconds delay) {
  ChildProcess writer({Program("store_crash_writer"), directory, std::to_string(round)});
  // One round in four is killed before the store can open, at any point.
  const std::string first = round % 4 == 3 ? "" : writer.ReadLine() + "\n";
  std::this_thread::sleep_for(delay);
  writer.Signal(SIGKILL);
  const Finished finished = writer.Wait();
  EXPECT_EQ(finished.exit_code, -SIGKILL) << "the writer ended by itself: " << finished.err;
  return first + finished.out;
}

TEST(StoreCrash, NothingAcknowledgedIsLost) {
  testing::TemporaryFolder directory;
  std::mt19937 random(20260);
  Acknowledged all;
  double slowest_opening = 0;
  for (int round = 0; round < kRounds && !::testing::Test::HasFailure(); ++round) {
    const std::chrono::microseconds delay(random() % 60'000);
    Acknowledged now;
    now.Read(RunAndKill(directory.path(), round, delay));

    const auto start = std::chrono::steady_clock::now();
    const std::unique_ptr<Store> store = OpenSqliteStore(directory.path());
    slowest_opening =
        std::max(slowest_opening, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    for (const int number : now.jobs) {
      const std::optional<JobRecord> job = store->GetJob(SampleJob(number).id);
      ASSERT_TRUE(job.has_value()) << "round " << round << " job " << number;
      EXPECT_EQ(job->spec, SampleJob(number).spec);
    }
    for (const auto& [number, count] : now.frames) {
      ExpectFrames(*store, number, count);
      ExpectWhole(directory / "jobs/" + SampleJob(number).id + ".db");
    }
    ExpectWhole(directory / "control.db");
    all.jobs.merge(now.jobs);
    all.frames.merge(now.frames);
  }
  EXPECT_LT(slowest_opening, 2.0);

  // Later rounds have not changed what earlier ones left.
  const std::unique_ptr<Store> store = OpenSqliteStore(directory.path());
  const std::vector<JobRecord> jobs = store->ListJobs(1 << 20, "", {});
  std::set<std::string> ids;
  for (const JobRecord& job : jobs) ids.insert(job.id);
  EXPECT_EQ(ids.size(), jobs.size());
  std::int64_t frames = 0;
  for (const int number : all.jobs) EXPECT_TRUE(ids.contains(SampleJob(number).id));
  for (const auto& [number, count] : all.frames) {
    EXPECT_GE(store->OpenFrames(SampleJob(number).id)->frame_count(), count);
    frames += count;
  }
  EXPECT_GT(all.jobs.size(), std::size_t{2} * kRounds);
  EXPECT_GT(frames, kRounds);
  std::printf("%d kills, %zu jobs and %lld frames acknowledged, slowest opening %.3f s\n", kRounds, all.jobs.size(),
              static_cast<long long>(frames), slowest_opening);
}

}  // namespace
}  // namespace fascicle::server
