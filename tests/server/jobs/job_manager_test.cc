// The life of jobs in one process: queue, workers, cancelling, deleting, failing.
#include "server/jobs/job_manager.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <latch>
#include <mutex>
#include <random>
#include <semaphore>
#include <set>
#include <thread>

#include "core/base/stop.h"
#include "tests/support/box_jobs.h"
#include "tests/support/store_samples.h"

namespace fascicle::server {
namespace {

using ::testing::HasSubstr;

class JobManagerTest : public ::testing::Test {
 protected:
  std::unique_ptr<Store> store_ = MakeMemoryStore();
};

TEST_F(JobManagerTest, RunsAJobToItsEnd) {
  JobManager manager(*store_, BoxCodec(), Workers(1));
  bool repeated = true;
  const JobView submitted = manager.Submit(BoxJob({}), &repeated);
  EXPECT_FALSE(repeated);
  const JobView done = WaitForEnd(manager, submitted.record.id);
  EXPECT_EQ(done.record.state, JobState::kSucceeded);
  EXPECT_EQ(done.record.attempt, 1);
  EXPECT_EQ(done.record.generation, 1);
  EXPECT_EQ(done.record.failure, "");
  EXPECT_EQ(done.record.spec, Serialize({}));
  EXPECT_LE(done.record.create_time_us, done.record.start_time_us);
  EXPECT_LT(done.record.start_time_us, done.record.end_time_us);
  EXPECT_EQ(done.progress.fraction, 1);
  EXPECT_EQ(done.progress.time, 0.4);
  EXPECT_GE(done.progress.step, 4000);
  EXPECT_EQ(done.frame_count, 21);

  const std::shared_ptr<FrameStore> frames = manager.Frames(submitted.record.id);
  EXPECT_EQ(frames->frame_count(), 21);
  EXPECT_EQ(frames->stored_bytes(), done.stored_bytes);
  EXPECT_THAT(*ReadGeometry(*frames), HasSubstr("box with"));
  EXPECT_EQ(StoredDigests(*frames), DigestsByCore({}));
  EXPECT_EQ(frames->ReadChunk(3, 0)->size(), 12 * sizeof(Vec3));
  EXPECT_EQ(store_->GetJob(submitted.record.id)->state, JobState::kSucceeded);
}

TEST_F(JobManagerTest, NumberOfThreadsDoesNotMatter) {
  JobManager manager(*store_, BoxCodec(), Workers(1));
  JobRecord record = BoxJob({});
  record.threads = 3;
  const std::string id = manager.Submit(record, nullptr).record.id;
  WaitForEnd(manager, id);
  EXPECT_EQ(StoredDigests(*manager.Frames(id)), DigestsByCore({}));
}

TEST_F(JobManagerTest, ARunsProfileCountsItsStages) {
  JobManager manager(*store_, BoxCodec(), Workers(1));
  const std::string id = manager.Submit(BoxJob({}), nullptr).record.id;
  const JobView done = WaitForEnd(manager, id);
  const std::string steps = std::to_string(done.record.step);
  for (const std::string& stage :
       {std::string("set-up/scene 1"), std::string("set-up/model 1"), "step " + steps, "step/elastic force " + steps,
        std::string("frame 21"), std::string("frame/digest 21"), std::string("checkpoint 21"),
        std::string("waiting for storage 22"), std::string("encode 21"), std::string("commit 21")}) {
    EXPECT_NE(("\n" + done.record.profile).find("\n" + stage + "\n"), std::string::npos) << stage << " is not in\n"
                                                                                         << done.record.profile;
  }
}

TEST_F(JobManagerTest, AFailedRunHasAProfileToo) {
  JobManager manager(*store_, BoxCodec(), Workers(1));
  const JobView done = WaitForEnd(manager, manager.Submit(BoxJob(Collapsing()), nullptr).record.id);
  EXPECT_EQ(done.record.state, JobState::kFailed);
  EXPECT_NE(done.record.profile.find("\nstep/elastic force "), std::string::npos) << done.record.profile;
}

TEST_F(JobManagerTest, TakesJobsInTheOrderOfTheirSubmission) {
  JobCodec codec = BoxCodec();
  std::vector<std::string> order;
  std::binary_semaphore go(0);
  codec.decode_scene = [&, decode = codec.decode_scene](const std::string& spec, AssetStore& assets, Profile* profile,
                                                        const std::stop_token& stop) {
    if (order.empty()) go.acquire();
    order.push_back(spec);
    return decode(spec, assets, profile, stop);
  };
  JobManager manager(*store_, codec, Workers(1));
  std::vector<std::string> submitted, ids;
  for (int i = 0; i < 5; ++i) {
    const BoxSpec spec = {.duration = 0.01 + 0.001 * i, .frame_interval = 0.01};
    submitted.push_back(Serialize(spec));
    ids.push_back(manager.Submit(BoxJob(spec), nullptr).record.id);
  }
  EXPECT_TRUE(Eventually([&] { return manager.Get(ids[0])->record.state == JobState::kStarting; }));
  for (int i = 1; i < 5; ++i) {
    EXPECT_EQ(manager.Get(ids[static_cast<std::size_t>(i)])->record.state, JobState::kQueued);
    EXPECT_EQ(manager.Get(ids[static_cast<std::size_t>(i)])->queue_position, i - 1);
  }
  EXPECT_EQ(manager.List(10, "", {JobState::kQueued}).front().queue_position, 3);
  EXPECT_TRUE(std::is_sorted(ids.begin(), ids.end()));
  go.release();
  WaitForEnd(manager, ids.back());
  EXPECT_EQ(order, submitted);
}

// Counts the scenes that workers decode.
JobCodec Counting(std::atomic<int>& decoded) {
  JobCodec codec = BoxCodec();
  codec.decode_scene = [&decoded, decode = codec.decode_scene](const std::string& spec, AssetStore& assets,
                                                               Profile* profile, const std::stop_token& stop) {
    ++decoded;
    return decode(spec, assets, profile, stop);
  };
  return codec;
}

TEST_F(JobManagerTest, AJobRunsTheSceneItWasSubmittedWith) {
  std::atomic<int> decoded = 0;
  JobManager manager(*store_, Counting(decoded), Workers(1));
  const BoxSpec spec;
  const JobView with = WaitForEnd(manager, manager.Submit(BoxJob(spec), nullptr, MakeScene(spec)).record.id);
  EXPECT_EQ(decoded, 0);
  const JobView without = WaitForEnd(manager, manager.Submit(BoxJob(spec), nullptr).record.id);
  EXPECT_EQ(decoded, 1);
  EXPECT_EQ(with.record.state, JobState::kSucceeded);
  const auto a = manager.Frames(with.record.id), b = manager.Frames(without.record.id);
  ASSERT_EQ(a->frame_count(), b->frame_count());
  EXPECT_EQ(a->ListFrames(0, 1000).back().digest, b->ListFrames(0, 1000).back().digest);
}

TEST_F(JobManagerTest, AsManyWaitingJobsHaveTheirSceneAsThereAreWorkers) {
  std::atomic<int> decoded = 0;
  JobManager manager(*store_, Counting(decoded), Workers(1));
  const std::string running = manager.Submit(BoxJob(Longest()), nullptr, MakeScene(Longest())).record.id;
  EXPECT_TRUE(WaitForFrames(manager, running, 1));
  const BoxSpec spec = {.duration = 0.01, .frame_interval = 0.01};
  std::weak_ptr<const Scene> first, second;
  std::vector<std::string> waiting;
  for (std::weak_ptr<const Scene>* kept : {&first, &second}) {
    const std::shared_ptr<const Scene> scene = MakeScene(spec);
    *kept = scene;
    waiting.push_back(manager.Submit(BoxJob(spec), nullptr, scene).record.id);
  }
  EXPECT_FALSE(first.expired());
  EXPECT_TRUE(second.expired());
  // What is cancelled makes room for the next.
  manager.Cancel(waiting[0]);
  EXPECT_TRUE(first.expired());
  waiting.push_back(manager.Submit(BoxJob(spec), nullptr, MakeScene(spec)).record.id);
  manager.Cancel(running);
  EXPECT_EQ(WaitForEnd(manager, waiting[1]).record.state, JobState::kSucceeded);
  EXPECT_EQ(WaitForEnd(manager, waiting[2]).record.state, JobState::kSucceeded);
  EXPECT_EQ(decoded, 1);
}

// A scene that takes forever to be decoded.
JobCodec Endless(std::binary_semaphore& begun) {
  JobCodec codec = BoxCodec();
  codec.decode_scene = [&](const std::string&, AssetStore&, Profile*,
                           const std::stop_token& stop) -> std::shared_ptr<const Scene> {
    begun.release();
    while (true) {
      ThrowIfStopped(stop);
      std::this_thread::yield();
    }
  };
  return codec;
}

TEST_F(JobManagerTest, CancelEndsThePreparation) {
  std::binary_semaphore begun(0);
  JobManager manager(*store_, Endless(begun), Workers(1));
  const std::string id = manager.Submit(BoxJob({}), nullptr).record.id;
  begun.acquire();
  manager.Cancel(id);
  EXPECT_EQ(WaitForEnd(manager, id).record.state, JobState::kCancelled);
}

TEST_F(JobManagerTest, DrainEndsThePreparationAndTheNextManagerTakesItUp) {
  std::string id;
  {
    std::binary_semaphore begun(0);
    JobManager manager(*store_, Endless(begun), Workers(1));
    id = manager.Submit(BoxJob({}), nullptr).record.id;
    begun.acquire();
    manager.Drain();
    EXPECT_EQ(store_->GetJob(id)->state, JobState::kQueued);
  }
  JobManager next(*store_, BoxCodec(), Workers(1));
  EXPECT_EQ(WaitForEnd(next, id).record.state, JobState::kSucceeded);
}

TEST_F(JobManagerTest, TwoJobsRunAtOnceOnTwoWorkers) {
  JobManager manager(*store_, BoxCodec(), Workers(2));
  const std::string first = manager.Submit(BoxJob(Longest()), nullptr).record.id;
  const std::string second = manager.Submit(BoxJob(Longest()), nullptr).record.id;
  const std::string third = manager.Submit(BoxJob(Longest()), nullptr).record.id;
  // Neither ends by itself: if both have frames, both are running.
  EXPECT_TRUE(WaitForFrames(manager, first, 2));
  EXPECT_TRUE(WaitForFrames(manager, second, 2));
  const std::int64_t before = manager.Get(first)->progress.step;
  EXPECT_TRUE(Eventually([&] { return manager.Get(first)->progress.step > before; }));
  EXPECT_EQ(manager.Get(first)->record.state, JobState::kRunning);
  EXPECT_EQ(manager.Get(second)->record.state, JobState::kRunning);
  EXPECT_EQ(manager.Get(third)->record.state, JobState::kQueued);
}

TEST_F(JobManagerTest, ARunningJobShowsItsProgress) {
  JobManager manager(*store_, BoxCodec(), Workers(1));
  const std::string id = manager.Submit(BoxJob(Longest()), nullptr).record.id;
  EXPECT_TRUE(WaitForFrames(manager, id, 2));
  EXPECT_TRUE(Eventually([&] { return manager.Get(id)->eta_seconds > 0; }));
  const JobView view = *manager.Get(id);
  EXPECT_GT(view.progress.fraction, 0);
  EXPECT_LT(view.progress.fraction, 1);
  EXPECT_NEAR(view.progress.time_step, 1e-4, 1e-6);  // steps end at frames
  EXPECT_GE(view.frame_count, 2);
  // The store is updated from time to time.
  EXPECT_TRUE(Eventually([&] { return store_->GetJob(id)->step > 0; }));
}

TEST_F(JobManagerTest, CancelsAQueuedJobAtOnce) {
  JobManager manager(*store_, BoxCodec(), Workers(1));
  const std::string running = manager.Submit(BoxJob(Longest()), nullptr).record.id;
  const std::string queued = manager.Submit(BoxJob(Longest()), nullptr).record.id;
  ASSERT_TRUE(WaitForFrames(manager, running, 1));
  const JobView cancelled = *manager.Cancel(queued);
  EXPECT_EQ(cancelled.record.state, JobState::kCancelled);
  EXPECT_GT(cancelled.record.end_time_us, 0);
  EXPECT_EQ(cancelled.record.attempt, 0);
  EXPECT_EQ(store_->GetJob(queued)->state, JobState::kCancelled);
  EXPECT_EQ(manager.Get(running)->record.state, JobState::kRunning);
}

TEST_F(JobManagerTest, CancelsARunningJobWithinAStepAndKeepsItsFrames) {
  JobManager manager(*store_, BoxCodec(), Workers(1));
  const std::string id = manager.Submit(BoxJob(Longest()), nullptr).record.id;
  ASSERT_TRUE(WaitForFrames(manager, id, 3));
  const auto start = std::chrono::steady_clock::now();
  const JobState state = manager.Cancel(id)->record.state;
  EXPECT_TRUE(state == JobState::kCancelling || state == JobState::kCancelled);
  const JobView done = WaitForEnd(manager, id);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(1));
  EXPECT_EQ(done.record.state, JobState::kCancelled);
  EXPECT_GE(done.frame_count, 3);
  EXPECT_EQ(manager.Frames(id)->frame_count(), done.frame_count);
  // A finished job is not changed.
  EXPECT_EQ(manager.Cancel(id)->record.end_time_us, done.record.end_time_us);
  EXPECT_FALSE(manager.Cancel("nobody").has_value());
}

TEST_F(JobManagerTest, DeletesFinalJobsAlone) {
  JobManager manager(*store_, BoxCodec(), Workers(1));
  const std::string running = manager.Submit(BoxJob(Longest()), nullptr).record.id;
  const std::string queued = manager.Submit(BoxJob({}), nullptr).record.id;
  EXPECT_EQ(manager.Delete(running), JobManager::DeleteResult::kActive);
  EXPECT_EQ(manager.Delete(queued), JobManager::DeleteResult::kActive);
  manager.Cancel(running);
  EXPECT_EQ(WaitForEnd(manager, queued).record.state, JobState::kSucceeded);
  const std::shared_ptr<FrameStore> frames = manager.Frames(queued);
  EXPECT_EQ(manager.Delete(queued), JobManager::DeleteResult::kDeleted);
  EXPECT_EQ(manager.Delete(queued), JobManager::DeleteResult::kNotFound);
  EXPECT_FALSE(manager.Get(queued).has_value());
  EXPECT_EQ(manager.Frames(queued), nullptr);
  EXPECT_EQ(frames->frame_count(), 21);
}

TEST_F(JobManagerTest, ARepeatedRequestGetsTheEarlierJob) {
  JobManager manager(*store_, BoxCodec(), Workers(2));
  std::vector<std::thread> clients;
  std::mutex mutex;
  std::set<std::string> ids;
  std::atomic<int> created = 0;
  for (int t = 0; t < 6; ++t) {
    clients.emplace_back([&, t] {
      for (int i = 0; i < 10; ++i) {
        JobRecord record =
            BoxJob({.duration = 0.01, .frame_interval = 0.01}, "request " + std::to_string((i + t) % 10));
        bool repeated = false;
        const JobView view = manager.Submit(record, &repeated);
        EXPECT_EQ(view.record.request_id, record.request_id);
        created += !repeated;
        const std::lock_guard lock(mutex);
        ids.insert(view.record.id);
      }
    });
  }
  for (std::thread& client : clients) client.join();
  EXPECT_EQ(created, 10);
  EXPECT_EQ(ids.size(), 10u);
  EXPECT_EQ(manager.List(100, "", {}).size(), 10u);
  for (const std::string& id : ids) EXPECT_EQ(WaitForEnd(manager, id).record.state, JobState::kSucceeded);
}

TEST_F(JobManagerTest, AJobThatFailsKeepsItsFramesAndSaysWhy) {
  JobManager manager(*store_, BoxCodec(), Workers(1));
  const std::string id = manager.Submit(BoxJob(Collapsing()), nullptr).record.id;
  const JobView done = WaitForEnd(manager, id);
  EXPECT_EQ(done.record.state, JobState::kFailed);
  EXPECT_NE(done.record.failure, "");
  EXPECT_EQ(done.record.failure.find("INTERNAL"), std::string::npos) << done.record.failure;
  EXPECT_GT(done.frame_count, 0);
  std::vector<std::string> expected = DigestsByCore(Collapsing());
  EXPECT_EQ(StoredDigests(*manager.Frames(id)), expected);
}

TEST_F(JobManagerTest, WhatACodecThrowsFailsTheJobAndNothingElse) {
  JobCodec codec = BoxCodec();
  std::atomic<int> frames = 0;
  codec.encode_frame = [&](const Frame& frame) -> std::string {
    if (frame.index == 5 && frames++ == 0) throw 42;  // once, and not a std::exception
    return EncodeFrame(frame);
  };
  JobManager manager(*store_, codec, Workers(1));
  const std::string encoding = manager.Submit(BoxJob({}), nullptr).record.id;
  const std::string decoding = manager.Submit(BoxJob({.cannot_be_decoded = 1}), nullptr).record.id;
  const std::string good = manager.Submit(BoxJob({}), nullptr).record.id;
  EXPECT_EQ(WaitForEnd(manager, good).record.state, JobState::kSucceeded);
  EXPECT_EQ(manager.Get(decoding)->record.state, JobState::kFailed);
  EXPECT_EQ(manager.Get(decoding)->record.failure, "INTERNAL: an asset was lost");
  EXPECT_EQ(manager.Get(encoding)->record.state, JobState::kFailed);
  EXPECT_THAT(manager.Get(encoding)->record.failure, HasSubstr("INTERNAL"));
  EXPECT_EQ(manager.Get(encoding)->frame_count, 5);
}

TEST_F(JobManagerTest, TheSolverRunsAheadOfTheDiskByAFewFrames) {
  JobCodec codec = BoxCodec();
  std::latch blocked(1);
  codec.encode_frame = [&](const Frame& frame) {
    if (frame.index == 2) blocked.wait();
    return EncodeFrame(frame);
  };
  JobManager manager(*store_, codec, Workers(1));
  const std::string id = manager.Submit(BoxJob(Longest()), nullptr).record.id;
  // Frame 2 is being written, 3 to 5 wait, and the solver has finished 6.
  EXPECT_TRUE(Eventually([&] { return manager.Get(id)->progress.time > 0.0599; }));
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  EXPECT_NEAR(manager.Get(id)->progress.time, 0.06, 1e-3);
  EXPECT_EQ(manager.Get(id)->frame_count, 2);
  blocked.count_down();
  EXPECT_TRUE(WaitForFrames(manager, id, 10));
}

TEST_F(JobManagerTest, SurvivesEverybodyAtOnce) {
  JobManager manager(*store_, BoxCodec(), Workers(2));
  std::vector<std::thread> clients;
  for (unsigned t = 0; t < 4; ++t) {
    clients.emplace_back([&, t] {
      std::mt19937 random(t);
      for (int i = 0; i < 25; ++i) {
        const BoxSpec spec = random() % 3 == 0 ? Longest() : BoxSpec{.duration = 0.02, .frame_interval = 0.01};
        const std::string id = manager.Submit(BoxJob(spec), nullptr).record.id;
        std::atomic<int> calls = 0;
        const JobManager::Subscription subscription = manager.Subscribe(id, [&] { ++calls; });
        manager.List(10, "", {});
        std::this_thread::sleep_for(std::chrono::milliseconds(random() % 8));
        EXPECT_TRUE(manager.Cancel(id).has_value());
        const JobState end = WaitForEnd(manager, id).record.state;
        EXPECT_TRUE(end == JobState::kCancelled || (spec.duration < 1 && end == JobState::kSucceeded));
        if (const std::shared_ptr<FrameStore> frames = manager.Frames(id)) frames->ListFrames(0, 100);
        if (random() % 2 == 0) {
          EXPECT_EQ(manager.Delete(id), JobManager::DeleteResult::kDeleted);
        }
      }
    });
  }
  for (std::thread& client : clients) client.join();
  for (const JobView& view : manager.List(1000, "", {})) EXPECT_TRUE(IsFinal(view.record.state));
}

}  // namespace
}  // namespace fascicle::server
