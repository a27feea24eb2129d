// A store that fails at any point ends at most the job concerned; the server survives.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "failing_store.h"
#include "server/jobs/job_manager.h"
#include "tests/support/box_jobs.h"

namespace fascicle::server {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

class JobFaultsTest : public ::testing::Test {
 protected:
  // The next job succeeds, whatever happened to the previous one.
  void ExpectGoodService(JobManager& manager) {
    store_.faults().reads.Heal();
    store_.faults().job_writes.Heal();
    store_.faults().frame_writes.Heal();
    const std::string id = manager.Submit(BoxJob(spec_), nullptr).record.id;
    EXPECT_EQ(WaitForEnd(manager, id).record.state, JobState::kSucceeded);
    EXPECT_EQ(StoredDigests(*manager.Frames(id)), expected_);
  }

  const BoxSpec spec_ = {.duration = 0.05, .frame_interval = 0.01};
  const std::vector<std::string> expected_ = DigestsByCore(spec_);
  FailingStore store_{MakeMemoryStore()};
};

TEST_F(JobFaultsTest, AFrameThatCannotBeStoredFailsTheJobWithTheFramesBefore) {
  JobManager manager(store_, BoxCodec(), Workers(1));
  for (int frames = 0; frames < 6; ++frames) {
    store_.faults().frame_writes.FailFrom(frames + 1);  // the first write is the geometry
    const std::string id = manager.Submit(BoxJob(spec_), nullptr).record.id;
    const JobView done = WaitForEnd(manager, id);
    EXPECT_EQ(done.record.state, JobState::kFailed);
    EXPECT_THAT(done.record.failure, StartsWith("STORAGE: disk full"));
    EXPECT_EQ(done.frame_count, frames);
    EXPECT_EQ(store_.GetJob(id)->state, JobState::kFailed);
    EXPECT_EQ(StoredDigests(*manager.Frames(id)), std::vector(expected_.begin(), expected_.begin() + frames));
  }
  ExpectGoodService(manager);
}

TEST_F(JobFaultsTest, EveryCallMayFailOnce) {
  for (Faults FailingStore::Points::*kind :
       {&FailingStore::Points::reads, &FailingStore::Points::job_writes, &FailingStore::Points::frame_writes}) {
    Faults& faults = store_.faults().*kind;
    JobManager manager(store_, BoxCodec(), Workers(1));
    int failed = 0, refused = 0;
    for (int call = 0; call < 12; ++call) {
      faults.FailFrom(call, 1);
      try {
        const std::string id = manager.Submit(BoxJob(spec_), nullptr).record.id;
        EXPECT_TRUE(Eventually([&] {
          try {
            return IsFinal(manager.Get(id)->record.state);
          } catch (const StoreError&) {
            return false;  // only the query failed
          }
        }));
        faults.Heal();
        const JobView view = *manager.Get(id);
        failed += view.record.state == JobState::kFailed;
        if (view.record.state == JobState::kSucceeded) {
          EXPECT_EQ(StoredDigests(*manager.Frames(id)), expected_);
        }
      } catch (const StoreError&) {
        ++refused;  // nothing was accepted
      }
    }
    if (kind == &FailingStore::Points::job_writes) {
      EXPECT_EQ(refused, 1);
    }
    EXPECT_GT(failed + refused, 0);
    ExpectGoodService(manager);
  }
}

TEST_F(JobFaultsTest, AnEndThatCannotBeStoredIsNotTold) {
  JobManager manager(store_, BoxCodec(), Workers(1));
  store_.faults().job_writes.FailFrom(3);  // accepted, starting, running, then the end
  const std::string id = manager.Submit(BoxJob(spec_), nullptr).record.id;
  EXPECT_TRUE(Eventually([&] { return !manager.Get(id)->waiting.empty(); }));
  EXPECT_THAT(manager.Get(id)->waiting, HasSubstr("disk full"));
  EXPECT_EQ(manager.Get(id)->record.state, JobState::kRunning);
  store_.faults().job_writes.Heal();
  EXPECT_EQ(WaitForEnd(manager, id).record.state, JobState::kSucceeded);
  EXPECT_EQ(manager.Get(id)->waiting, "");
}

TEST_F(JobFaultsTest, AJobWhoseEndCannotBeStoredIsResumedByTheNextProcess) {
  std::string id;
  {
    JobManager manager(store_, BoxCodec(), Workers(1));
    store_.faults().job_writes.FailFrom(3);
    id = manager.Submit(BoxJob(spec_), nullptr).record.id;
    EXPECT_TRUE(Eventually([&] { return !manager.Get(id)->waiting.empty(); }));
  }
  store_.faults().job_writes.Heal();
  EXPECT_EQ(store_.GetJob(id)->state, JobState::kRunning);
  JobManager manager(store_, BoxCodec(), Workers(1));
  EXPECT_EQ(WaitForEnd(manager, id).record.state, JobState::kSucceeded);
  EXPECT_EQ(StoredDigests(*manager.Frames(id)), expected_);
}

TEST_F(JobFaultsTest, ACancelThatCannotBeStoredIsToldAndDoesNothing) {
  JobManager manager(store_, BoxCodec(), Workers(1));
  const std::string id = manager.Submit(BoxJob(Longest()), nullptr).record.id;
  ASSERT_TRUE(WaitForFrames(manager, id, 1));
  store_.faults().job_writes.FailFrom(0);
  EXPECT_THROW(manager.Cancel(id), StoreError);
  const std::int64_t frames = manager.Get(id)->frame_count;
  EXPECT_TRUE(WaitForFrames(manager, id, frames + 2));
  store_.faults().job_writes.Heal();
  manager.Cancel(id);
  EXPECT_EQ(WaitForEnd(manager, id).record.state, JobState::kCancelled);
}

}  // namespace
}  // namespace fascicle::server
