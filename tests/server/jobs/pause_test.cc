// Pausing and resuming jobs, in one process and over several.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <random>
#include <thread>

#include "server/jobs/job_manager.h"
#include "tests/support/box_jobs.h"
#include "tests/support/files.h"

namespace fascicle::server {
namespace {

class PauseTest : public ::testing::TestWithParam<bool> {
 protected:
  // Ends the process, as seen by the store.
  void ReopenStore() {
    if (!GetParam()) return;
    store_.reset();
    store_ = OpenSqliteStore(directory_.path());
  }
  JobState StateOf(JobManager& manager, const std::string& id) { return manager.Get(id)->record.state; }
  bool WaitForState(JobManager& manager, const std::string& id, JobState state) {
    return Eventually([&] { return StateOf(manager, id) == state; });
  }

  testing::TemporaryFolder directory_;
  std::unique_ptr<Store> store_ = GetParam() ? OpenSqliteStore(directory_.path()) : MakeMemoryStore();
};

constexpr BoxSpec kSome = {.duration = 3, .frame_interval = 0.02};

TEST_P(PauseTest, APausedJobLeavesItsWorkerAndGoesOnToTheSameFrames) {
  JobManager manager(*store_, BoxCodec(), Workers(1));
  const std::string id = manager.Submit(BoxJob(kSome), nullptr).record.id;
  const std::string waiting = manager.Submit(BoxJob({}), nullptr).record.id;
  ASSERT_TRUE(WaitForFrames(manager, id, 5));
  const JobState answer = manager.Pause(id)->record.state;
  EXPECT_TRUE(answer == JobState::kPausing || answer == JobState::kPaused);
  ASSERT_TRUE(WaitForState(manager, id, JobState::kPaused));
  EXPECT_EQ(WaitForEnd(manager, waiting).record.state, JobState::kSucceeded);
  EXPECT_EQ(StateOf(manager, id), JobState::kPaused);
  EXPECT_EQ(manager.Get(id)->record.end_time_us, 0);
  EXPECT_LT(manager.Get(id)->frame_count, 151);
  EXPECT_EQ(manager.Pause(id)->record.state, JobState::kPaused) << "it stays as it is";
  EXPECT_EQ(manager.Delete(id), JobManager::DeleteResult::kActive);
  EXPECT_EQ(manager.Restart(id, false), JobManager::RestartResult::kActive);
  EXPECT_NE(manager.Resume(id)->record.state, JobState::kPaused);
  const JobView done = WaitForEnd(manager, id);
  EXPECT_EQ(done.record.state, JobState::kSucceeded);
  EXPECT_EQ(done.record.attempt, 2);
  EXPECT_EQ(done.record.generation, 1);
  EXPECT_EQ(StoredDigests(*manager.Frames(id)), DigestsByCore(kSome));
}

TEST_P(PauseTest, PausedJobsStayPausedInTheNextProcess) {
  std::string running, queued;
  {
    JobManager manager(*store_, BoxCodec(), Workers(1));
    running = manager.Submit(BoxJob(kSome), nullptr).record.id;
    queued = manager.Submit(BoxJob({}), nullptr).record.id;
    EXPECT_EQ(manager.Pause(queued)->record.state, JobState::kPaused);
    ASSERT_TRUE(WaitForFrames(manager, running, 5));
    manager.Pause(running);
    manager.Drain();  // also while it is about to pause
    EXPECT_EQ(StateOf(manager, running), JobState::kPaused);
  }
  ReopenStore();
  JobManager manager(*store_, BoxCodec(), Workers(2));
  const std::string other = manager.Submit(BoxJob({}), nullptr).record.id;
  EXPECT_EQ(WaitForEnd(manager, other).record.state, JobState::kSucceeded);
  EXPECT_EQ(StateOf(manager, queued), JobState::kPaused);
  EXPECT_EQ(StateOf(manager, running), JobState::kPaused);
  manager.Resume(running);
  manager.Resume(queued);
  EXPECT_EQ(WaitForEnd(manager, running).record.state, JobState::kSucceeded);
  EXPECT_EQ(WaitForEnd(manager, queued).record.state, JobState::kSucceeded);
  EXPECT_EQ(StoredDigests(*manager.Frames(running)), DigestsByCore(kSome));
}

// The process ends between the request and the worker's stop.
TEST_P(PauseTest, APauseThatWasAcknowledgedOutlivesAKill) {
  std::string id;
  {
    JobManager manager(*store_, BoxCodec(), Workers(1));
    id = manager.Submit(BoxJob(kSome), nullptr).record.id;
    ASSERT_TRUE(WaitForFrames(manager, id, 5));
  }
  JobRecord record = *store_->GetJob(id);
  record.state = JobState::kPausing;
  store_->UpdateJob(record);
  ReopenStore();
  JobManager manager(*store_, BoxCodec(), Workers(1));
  EXPECT_EQ(StateOf(manager, id), JobState::kPaused);
  manager.Resume(id);
  EXPECT_EQ(WaitForEnd(manager, id).record.state, JobState::kSucceeded);
  EXPECT_EQ(StoredDigests(*manager.Frames(id)), DigestsByCore(kSome));
}

TEST_P(PauseTest, PausedJobsCanBeCancelledAndFinalOnesCannotBePaused) {
  JobManager manager(*store_, BoxCodec(), Workers(1));
  const std::string id = manager.Submit(BoxJob(Longest()), nullptr).record.id;
  manager.Pause(id);
  ASSERT_TRUE(WaitForState(manager, id, JobState::kPaused));
  EXPECT_EQ(manager.Cancel(id)->record.state, JobState::kCancelled);
  EXPECT_GT(manager.Get(id)->record.end_time_us, 0);
  EXPECT_EQ(manager.Pause(id)->record.state, JobState::kCancelled);
  EXPECT_EQ(manager.Resume(id)->record.state, JobState::kCancelled);
  EXPECT_EQ(manager.Delete(id), JobManager::DeleteResult::kDeleted);
  EXPECT_FALSE(manager.Pause(id).has_value());
  EXPECT_FALSE(manager.Resume(id).has_value());
}

// Many threads ask for everything at once; afterwards every job can be brought to its end, with the right frames.
TEST_P(PauseTest, AnythingMayBeAskedForAtAnyTime) {
  constexpr int kThreads = 4, kRequests = 60, kJobs = 4;
  constexpr BoxSpec kSmall = {.duration = 0.6, .frame_interval = 0.02};
  JobManagerOptions options = Workers(2);
  options.max_running_per_owner = 1;
  JobManager manager(*store_, BoxCodec(), options);
  std::vector<std::string> ids;
  for (int i = 0; i < kJobs; ++i) {
    JobRecord job = BoxJob(kSmall);
    job.owner = i % 2 == 0 ? "ann" : "bob";
    ids.push_back(manager.Submit(job, nullptr).record.id);
  }
  std::vector<std::thread> threads;
  for (unsigned t = 0; t < kThreads; ++t) {
    threads.emplace_back([&, t] {
      std::mt19937 random(t);
      for (int i = 0; i < kRequests; ++i) {
        const std::string& id = ids[random() % kJobs];
        switch (random() % 6) {
          case 0:
          case 1:
            manager.Pause(id);
            break;
          case 2:
            manager.Resume(id);
            break;
          case 3:
            manager.Cancel(id);
            break;
          case 4:
            manager.Restart(id, random() % 2 == 0);
            break;
          default:
            manager.ChangeSettings(id, [&](JobRecord& job) { job.priority = static_cast<int>(random() % 5); });
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(random() % 4));
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const std::string& id : ids) {
    EXPECT_TRUE(Eventually([&] {
      const JobState state = manager.Resume(id)->record.state;
      if (IsFinal(state) && state != JobState::kSucceeded) manager.Restart(id, false);
      return state == JobState::kSucceeded;
    })) << id;
    EXPECT_EQ(StoredDigests(*manager.Frames(id)), DigestsByCore(kSmall));
    EXPECT_EQ(manager.Get(id)->record.generation, 1);
  }
  EXPECT_TRUE(Eventually([&] { return manager.Load().running == 0 && manager.Load().queued == 0; }));
}

INSTANTIATE_TEST_SUITE_P(Stores, PauseTest, ::testing::Bool(),
                         [](const auto& test) { return test.param ? "Sqlite" : "Memory"; });

}  // namespace
}  // namespace fascicle::server
