// Ten thousand jobs: how long a list takes, and a restart.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <random>
#include <thread>
#include <vector>

#include "server/jobs/job_manager.h"
#include "tests/support/box_jobs.h"
#include "tests/support/files.h"
#include "tests/support/store_samples.h"

namespace fascicle::server {
namespace {

// Processor time of this thread, which does not depend on what else the machine does, and the time of the clock [s].
struct Times {
  double processor = 0;
  double clock = 0;

  static Times Now() {
    timespec time = {};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return {static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec),
            std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count()};
  }
  static Times Since(const Times& start) {
    const Times now = Now();
    return {now.processor - start.processor, now.clock - start.clock};
  }
};

double Quantile(std::vector<double> values, double part) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(part * static_cast<double>(values.size() - 1))];
}

// 1,000, or FASCICLE_JOBS: with 10,000 the figures are those of a release.
int NumberOfJobs() {
  const char* number = std::getenv("FASCICLE_JOBS");
  return number == nullptr ? 1000 : std::atoi(number);
}

JobRecord Job(int number) {
  std::mt19937 random(static_cast<unsigned>(number));
  JobRecord job = SampleJob(number);
  job.owner = "owner" + std::to_string(random() % 7);
  job.labels = {{"study", std::to_string(random() % 20)}, {"run", std::to_string(number)}};
  job.scene_name = "muscle " + std::to_string(random() % 50);
  job.state = number % 10 == 0 ? JobState::kQueued : JobState::kSucceeded;
  if (IsFinal(job.state)) job.end_time_us = job.create_time_us + 1'000'000;
  job.stored_bytes = static_cast<std::int64_t>(random() % 1'000'000'000);
  job.profile = SampleBytes(static_cast<std::uint64_t>(number), 3000);
  return job;
}

void Fill(Store& store, int count) {
  constexpr int kThreads = 16;
  std::vector<std::thread> threads;
  for (int t = 0; t < kThreads; ++t) {
    threads.emplace_back([&, t] {
      JobRecord existing;
      for (int i = t; i < count; i += kThreads) store.CreateJob(Job(i), &existing);
    });
  }
  for (std::thread& thread : threads) thread.join();
}

// Pages of 50 as clients ask for them.
std::vector<JobQuery> Queries() {
  using Relation = JobCondition::Relation;
  std::vector<JobQuery> queries(6, JobQuery{.limit = 51});
  queries[1].filter.groups = {{{.field = JobField::kOwner, .text = "owner3"}}};
  queries[1].order = JobField::kStoredBytes;
  queries[2].filter.groups = {{{.field = JobField::kLabel, .text = "7", .key = "study"}},
                              {{.field = JobField::kState, .number = static_cast<int>(JobState::kSucceeded)}}};
  queries[3].filter.groups = {{{.field = JobField::kName, .relation = Relation::kContains, .text = "nowhere"}}};
  queries[4].filter.groups = {{{.field = JobField::kState, .number = static_cast<int>(JobState::kQueued)}}};
  queries[5].order = JobField::kName;
  for (int i = 0; i < 32; ++i) {
    queries[5].filter.groups.push_back(
        {{.field = JobField::kName, .relation = Relation::kContains, .text = "muscle", .is_negated = false}});
  }
  return queries;
}

TEST(ManyJobs, ListsAndRestartsTakeLittleTime) {
#ifdef FASCICLE_SANITIZED
  GTEST_SKIP() << "sanitized programs are slow";
#endif
  const int count = NumberOfJobs();
  const bool is_release = count >= 10'000;
  testing::TemporaryFolder directory;
  Fill(*OpenSqliteStore(directory.path()), count);

  const Times start = Times::Now();
  const std::unique_ptr<Store> store = OpenSqliteStore(directory.path());
  JobManager manager(*store, BoxCodec(), Workers(0));
  const Times restart = Times::Since(start);
  EXPECT_EQ(manager.Load().queued, (count + 9) / 10);

  std::vector<double> processor, clock;
  for (int round = 0; round < (is_release ? 100 : 10); ++round) {
    for (const JobQuery& query : Queries()) {
      const Times asked = Times::Now();
      manager.Find(query);
      const Times time = Times::Since(asked);
      processor.push_back(time.processor);
      clock.push_back(time.clock);
    }
  }
  const double p99 = Quantile(processor, 0.99);
  std::printf("%d jobs: list p50 %.1f ms, p99 %.1f ms of processor time, %.1f and %.1f ms by the clock\n", count,
              1e3 * Quantile(processor, 0.5), 1e3 * p99, 1e3 * Quantile(clock, 0.5), 1e3 * Quantile(clock, 0.99));
  std::printf("restart %.2f s of processor time, %.2f s by the clock\n", restart.processor, restart.clock);
  EXPECT_EQ(manager.Find(Queries()[4]).size(), 51u);
  EXPECT_LT(p99, 0.05);
  EXPECT_LT(restart.processor, 2);
}

}  // namespace
}  // namespace fascicle::server
