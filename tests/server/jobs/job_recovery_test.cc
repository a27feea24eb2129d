// The fate of jobs if the process ends, with each store.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>

#include "server/jobs/job_manager.h"
#include "tests/support/box_jobs.h"
#include "tests/support/files.h"
#include "tests/support/store_samples.h"

namespace fascicle::server {
namespace {

class JobRecoveryTest : public ::testing::TestWithParam<bool> {
 protected:
  // Ends the process, as seen by the store.
  void ReopenStore() {
    if (!GetParam()) return;
    store_.reset();
    store_ = OpenSqliteStore(directory_.path());
  }

  testing::TemporaryFolder directory_;
  std::unique_ptr<Store> store_ = GetParam() ? OpenSqliteStore(directory_.path()) : MakeMemoryStore();
};

// Counts the frames made by a manager's workers.
JobCodec CountingCodec(std::atomic<int>& count, std::atomic<std::int64_t>& first) {
  JobCodec codec = BoxCodec();
  codec.encode_frame = [&](const Frame& frame) {
    if (count++ == 0) first = frame.index;
    return EncodeFrame(frame);
  };
  return codec;
}

TEST_P(JobRecoveryTest, ADrainedJobGoesOnFromItsCheckpointToTheSameFrames) {
  const BoxSpec spec = {.duration = 3, .frame_interval = 0.02};
  std::string id, waiting;
  std::int64_t stored = 0;
  {
    JobManager manager(*store_, BoxCodec(), Workers(1));
    id = manager.Submit(BoxJob(spec), nullptr).record.id;
    waiting = manager.Submit(BoxJob({}), nullptr).record.id;
    ASSERT_TRUE(WaitForFrames(manager, id, 4));
    manager.Drain();
    manager.Drain();
    const JobView view = *manager.Get(id);
    ASSERT_EQ(view.record.state, JobState::kQueued);
    EXPECT_EQ(manager.Get(waiting)->record.state, JobState::kQueued);
    stored = view.frame_count;
    EXPECT_LT(stored, 151);
    // A drained server still accepts jobs for the next server.
    EXPECT_EQ(manager.Submit(BoxJob(spec, "late"), nullptr).record.state, JobState::kQueued);
  }
  ReopenStore();
  std::atomic<int> count = 0;
  std::atomic<std::int64_t> first = -1;
  JobManager manager(*store_, CountingCodec(count, first), Workers(2));
  const JobView done = WaitForEnd(manager, id);
  EXPECT_EQ(done.record.state, JobState::kSucceeded);
  EXPECT_EQ(done.record.attempt, 2);
  EXPECT_EQ(done.record.generation, 1);
  EXPECT_EQ(StoredDigests(*manager.Frames(id)), DigestsByCore(spec));
  EXPECT_EQ(WaitForEnd(manager, waiting).record.state, JobState::kSucceeded);
  EXPECT_EQ(manager.Get(waiting)->record.attempt, 1);
}

TEST_P(JobRecoveryTest, TheProfileOfARunIsKeptAndTheNextOneAddsToIt) {
  const BoxSpec spec = {.duration = 3, .frame_interval = 0.02};
  std::string id, first;
  {
    JobManager manager(*store_, BoxCodec(), Workers(1));
    id = manager.Submit(BoxJob(spec), nullptr).record.id;
    ASSERT_TRUE(WaitForFrames(manager, id, 10));
    manager.Drain();
    first = manager.Get(id)->record.profile;
  }
  EXPECT_THAT(first,
              ::testing::AllOf(::testing::HasSubstr("set-up/scene 1\n"), ::testing::HasSubstr("\nstep/elastic force "),
                               ::testing::HasSubstr("\ncommit "), ::testing::HasSubstr("\ncheckpoint ")));
  ReopenStore();
  JobManager manager(*store_, BoxCodec(), Workers(1));
  EXPECT_TRUE(manager.Get(id)->record.profile.starts_with(first));
  const std::string both = WaitForEnd(manager, id).record.profile;
  EXPECT_TRUE(both.starts_with(first));
  EXPECT_NE(both.substr(first.size()).find("set-up/scene 1\n"), std::string::npos);
}

TEST_P(JobRecoveryTest, DoesNotRepeatWhatTheCheckpointHolds) {
  const BoxSpec spec = {.duration = 3, .frame_interval = 0.02};
  std::string id;
  std::int64_t stored = 0;
  {
    JobManager manager(*store_, BoxCodec(), Workers(1));
    id = manager.Submit(BoxJob(spec), nullptr).record.id;
    ASSERT_TRUE(WaitForFrames(manager, id, 10));
    manager.Drain();
    stored = manager.Get(id)->frame_count;
  }
  std::atomic<int> count = 0;
  std::atomic<std::int64_t> first = -1;
  JobManager manager(*store_, CountingCodec(count, first), Workers(1));
  WaitForEnd(manager, id);
  EXPECT_EQ(first, stored);  // every frame had a checkpoint
  EXPECT_EQ(count, 151 - stored);
}

TEST_P(JobRecoveryTest, FramesAfterTheCheckpointAreMadeAgainAndAreTheSame) {
  const BoxSpec spec = {.duration = 1, .frame_interval = 0.02};
  std::string id;
  JobManagerOptions one_checkpoint = Workers(1);
  one_checkpoint.checkpoint_interval = std::chrono::hours(1);  // only with the last frame, which is not reached
  {
    JobManager manager(*store_, BoxCodec(), one_checkpoint);
    id = manager.Submit(BoxJob(spec), nullptr).record.id;
    ASSERT_TRUE(WaitForFrames(manager, id, 5));
    manager.Drain();
  }
  ReopenStore();
  std::atomic<int> count = 0;
  std::atomic<std::int64_t> first = -1;
  JobManager manager(*store_, CountingCodec(count, first), Workers(1));
  const JobView done = WaitForEnd(manager, id);
  EXPECT_EQ(first, 0);
  EXPECT_EQ(done.record.generation, 1);
  EXPECT_EQ(StoredDigests(*manager.Frames(id)), DigestsByCore(spec));
}

TEST_P(JobRecoveryTest, FramesThatComeOutDifferentlyChangeTheGeneration) {
  JobRecord record = BoxJob({});
  record.id = SampleJob(1).id;
  record.state = JobState::kRunning;
  record.attempt = 1;
  JobRecord existing;
  store_->CreateJob(record, &existing);
  const std::vector<std::string> expected = DigestsByCore({});
  {
    const std::shared_ptr<FrameStore> frames = store_->OpenFrames(record.id);
    frames->PutFrame({0, 0, 0, 1, expected[0]}, "x", "not a checkpoint");
    frames->PutFrame({1, 0, 0, 1, "of another version"}, "x", "");
    frames->PutFrame({2, 0, 0, 1, "of another version too"}, "x", "");
  }
  JobManager manager(*store_, BoxCodec(), Workers(1));
  const JobView done = WaitForEnd(manager, record.id);
  EXPECT_EQ(done.record.state, JobState::kSucceeded);
  EXPECT_EQ(done.record.generation, 2);
  EXPECT_EQ(done.record.attempt, 2);
  EXPECT_EQ(StoredDigests(*manager.Frames(record.id)), expected);
}

TEST_P(JobRecoveryTest, TakesUpJobsInWhateverStateTheyWereLeft) {
  const std::vector<JobState> left = {JobState::kQueued,     JobState::kStarting, JobState::kRunning,
                                      JobState::kCancelling, JobState::kFailed,   JobState::kSucceeded};
  std::vector<std::string> ids;
  for (std::size_t i = 0; i < left.size(); ++i) {
    JobRecord record = BoxJob({.duration = 0.02, .frame_interval = 0.01});
    record.id = SampleJob(static_cast<int>(i)).id;
    record.state = left[i];
    record.attempt = left[i] == JobState::kQueued ? 0 : 1;
    record.failure = left[i] == JobState::kFailed ? "old" : "";
    JobRecord existing;
    store_->CreateJob(record, &existing);
    ids.push_back(record.id);
  }
  ReopenStore();
  JobManager manager(*store_, BoxCodec(), Workers(1));
  for (std::size_t i = 0; i < 3; ++i) {
    const JobView view = WaitForEnd(manager, ids[i]);
    EXPECT_EQ(view.record.state, JobState::kSucceeded);
    EXPECT_EQ(view.record.attempt, i == 0 ? 1 : 2);
  }
  EXPECT_EQ(manager.Get(ids[3])->record.state, JobState::kCancelled);
  EXPECT_GT(manager.Get(ids[3])->record.end_time_us, 0);
  EXPECT_EQ(manager.Get(ids[4])->record.state, JobState::kFailed);
  EXPECT_EQ(manager.Get(ids[4])->record.failure, "old");
  EXPECT_EQ(manager.Get(ids[5])->record.attempt, 1);
  // New ids are greater than the existing ones.
  EXPECT_GT(manager.Submit(BoxJob({}), nullptr).record.id, ids.back());
}

TEST_P(JobRecoveryTest, AJobCanBeCancelledAfterTheDrain) {
  JobManager manager(*store_, BoxCodec(), Workers(1));
  const std::string id = manager.Submit(BoxJob(Longest()), nullptr).record.id;
  ASSERT_TRUE(WaitForFrames(manager, id, 2));
  manager.Drain();
  EXPECT_EQ(manager.Cancel(id)->record.state, JobState::kCancelled);
  EXPECT_EQ(store_->GetJob(id)->state, JobState::kCancelled);
}

INSTANTIATE_TEST_SUITE_P(Stores, JobRecoveryTest, ::testing::Bool(),
                         [](const auto& test) { return test.param ? "Sqlite" : "Memory"; });

TEST(JobRecovery, ADamagedFrameFileFailsItsJobAlone) {
  testing::TemporaryFolder directory;
  std::string damaged, good;
  {
    const std::unique_ptr<Store> store = OpenSqliteStore(directory.path());
    JobManager manager(*store, BoxCodec(), Workers(2));
    damaged = manager.Submit(BoxJob(Longest()), nullptr).record.id;
    good = manager.Submit(BoxJob({.duration = 1}), nullptr).record.id;
    ASSERT_TRUE(WaitForFrames(manager, damaged, 2));
  }
  const std::string path = directory / "jobs/" + damaged + ".db";
  std::filesystem::resize_file(path, 0);
  std::filesystem::resize_file(path, 100'000);  // zeros
  const std::unique_ptr<Store> store = OpenSqliteStore(directory.path());
  JobManager manager(*store, BoxCodec(), Workers(1));
  const JobView failed = WaitForEnd(manager, damaged);
  EXPECT_EQ(failed.record.state, JobState::kFailed);
  EXPECT_THAT(failed.record.failure, ::testing::StartsWith("STORAGE: " + path));
  EXPECT_EQ(WaitForEnd(manager, good).record.state, JobState::kSucceeded);
}

}  // namespace
}  // namespace fascicle::server
