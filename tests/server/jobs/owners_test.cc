// Owners, their limits and their shares; threads; what is kept.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <mutex>
#include <set>
#include <thread>

#include "core/base/digest.h"
#include "server/jobs/job_manager.h"
#include "tests/support/box_jobs.h"
#include "tests/support/files.h"

namespace fascicle::server {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr BoxSpec kShort = {.duration = 0.02, .frame_interval = 0.01};

JobRecord JobOf(const std::string& owner, const BoxSpec& spec = kShort) {
  JobRecord job = BoxJob(spec);
  job.owner = owner;
  return job;
}

// What was told of jobs, as OWNER EVENT.
class Events {
 public:
  void Add(const JobRecord& job, std::string_view event) {
    const std::lock_guard lock(mutex_);
    all_.push_back(job.owner + " " + std::string(event));
  }
  std::vector<std::string> Of(const std::string& event) {
    const std::lock_guard lock(mutex_);
    std::vector<std::string> owners;
    for (const std::string& one : all_) {
      if (one.ends_with(" " + event)) owners.push_back(one.substr(0, one.find(' ')));
    }
    return owners;
  }

 private:
  std::mutex mutex_;
  std::vector<std::string> all_;
};

class OwnersTest : public ::testing::Test {
 protected:
  JobManagerOptions Options(int workers) {
    JobManagerOptions options = Workers(workers);
    options.retention_interval = std::chrono::milliseconds(20);
    options.on_event = [this](const JobRecord& job, std::string_view event) { events_.Add(job, event); };
    return options;
  }

  testing::TemporaryFolder directory_;
  std::unique_ptr<Store> store_ = OpenSqliteStore(directory_.path());
  Events events_;
};

TEST_F(OwnersTest, OneJobOfAnOwnerDoesNotWaitForTheManyOfAnother) {
  JobManager manager(*store_, BoxCodec(), Options(1));
  const std::string first = manager.Submit(JobOf("first", Longest()), nullptr).record.id;
  ASSERT_TRUE(WaitForFrames(manager, first, 1));
  std::vector<std::string> ids;
  for (int i = 0; i < 6; ++i) ids.push_back(manager.Submit(JobOf("ann"), nullptr).record.id);
  ids.push_back(manager.Submit(JobOf("bob"), nullptr).record.id);
  JobRecord urgent = JobOf("ann");
  urgent.priority = 3;
  ids.push_back(manager.Submit(urgent, nullptr).record.id);
  EXPECT_EQ(manager.Get(ids.back())->queue_position, 0);
  EXPECT_EQ(manager.Get(ids[6])->queue_position, 1);
  EXPECT_EQ(manager.Get(ids[5])->queue_position, 7);
  manager.Cancel(first);
  for (const std::string& id : ids) WaitForEnd(manager, id);
  const std::vector<std::string> started = events_.Of("started");
  EXPECT_THAT(std::vector(started.begin(), started.begin() + 3), ElementsAre("first", "ann", "bob"));
}

TEST_F(OwnersTest, LimitsOfAnOwnerAreToldAndLeaveOthersAlone) {
  JobManagerOptions options = Options(1);
  options.max_queued_per_owner = 2;
  JobManager manager(*store_, BoxCodec(), options);
  const std::string running = manager.Submit(JobOf("ann", Longest()), nullptr).record.id;
  ASSERT_TRUE(WaitForFrames(manager, running, 1));
  JobRecord repeated = JobOf("ann");
  repeated.request_id = "once";
  const std::string waiting = manager.Submit(repeated, nullptr).record.id;
  manager.Submit(JobOf("ann"), nullptr);
  try {
    manager.Submit(JobOf("ann"), nullptr);
    FAIL() << "the third in the queue";
  } catch (const OwnerLimitError& error) {
    EXPECT_THAT(error.what(), HasSubstr("2 jobs in the queue"));
  }
  // A request that is repeated is answered all the same.
  bool is_repeated = false;
  EXPECT_EQ(manager.Submit(repeated, &is_repeated).record.id, waiting);
  EXPECT_TRUE(is_repeated);
  manager.Submit(JobOf("bob"), nullptr);
  manager.Cancel(waiting);
  manager.Submit(JobOf("ann"), nullptr);
}

TEST_F(OwnersTest, JobsThatAreSubmittedTogetherFitTogetherOrNotAtAll) {
  JobManagerOptions options = Options(0);
  options.max_queued_per_owner = 3;
  JobManager manager(*store_, BoxCodec(), options);
  std::vector<JobRecord> batch = {JobOf("ann"), JobOf("bob"), JobOf("ann")};
  for (std::size_t i = 0; i < batch.size(); ++i) batch[i].request_id = "request " + std::to_string(i);
  const std::vector<SubmittedJob> first = manager.Submit(batch);
  ASSERT_EQ(first.size(), 3U);
  EXPECT_EQ(first[2].view.queue_position, 2);
  try {
    manager.Submit({JobOf("bob"), JobOf("ann"), JobOf("ann")});
    FAIL() << "four jobs of ann";
  } catch (const OwnerLimitError& error) {
    EXPECT_THAT(error.what(), HasSubstr("2 are there, and 2 more would come"));
  }
  EXPECT_EQ(manager.List(10, "", {}).size(), 3U) << "none of the batch was created";
  manager.Submit(JobOf("ann"), nullptr);
  // Repeated, it is answered although there is no room; with another job, it is refused.
  const std::vector<SubmittedJob> again = manager.Submit(batch);
  for (std::size_t i = 0; i < batch.size(); ++i) {
    EXPECT_EQ(again[i].view.record.id, first[i].view.record.id);
    EXPECT_TRUE(again[i].is_repeated);
  }
  batch[1].request_digest = "another";
  EXPECT_THROW(manager.Submit(batch), RequestReusedError);
}

TEST_F(OwnersTest, ExactlyAsManyJobsAreAcceptedAtOnceAsTheLimitAllows) {
  constexpr int kThreads = 8, kLimit = 5;
  JobManagerOptions options = Options(0);
  options.max_queued_per_owner = kLimit;
  JobManager manager(*store_, BoxCodec(), options);
  std::atomic<int> accepted = 0;
  std::vector<std::thread> threads;
  for (int t = 0; t < kThreads; ++t) {
    threads.emplace_back([&] {
      try {
        manager.Submit(JobOf("ann"), nullptr);
        ++accepted;
      } catch (const OwnerLimitError&) {
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(accepted, kLimit);
  EXPECT_EQ(manager.Load().queued, kLimit);
}

TEST_F(OwnersTest, WhoHasStoredTooMuchMustDeleteSomething) {
  JobManagerOptions options = Options(1);
  options.max_stored_per_owner = 100;
  JobManager manager(*store_, BoxCodec(), options);
  const std::string id = manager.Submit(JobOf("ann"), nullptr).record.id;
  WaitForEnd(manager, id);
  EXPECT_THROW(manager.Submit(JobOf("ann"), nullptr), OwnerLimitError);
  manager.Submit(JobOf("bob"), nullptr);
  manager.Delete(id);
  manager.Submit(JobOf("ann"), nullptr);
}

TEST_F(OwnersTest, AllJobsTogetherHaveNoMoreThreadsThanCores) {
  const int cores = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  const auto threads_of_two = [&](bool oversubscribe) {
    JobManagerOptions options = Options(2);
    options.oversubscribe = oversubscribe;
    JobManager manager(*store_, BoxCodec(), options);
    JobRecord job = JobOf("ann", Longest());
    job.threads = cores;
    std::vector<std::string> ids;
    for (int i = 0; i < 2; ++i) ids.push_back(manager.Submit(job, nullptr).record.id);
    for (const std::string& id : ids) EXPECT_TRUE(WaitForFrames(manager, id, 1));
    EXPECT_EQ(manager.Get(ids[0])->threads + manager.Get(ids[1])->threads, manager.Load().threads);
    const int threads = manager.Load().threads;
    for (const std::string& id : ids) manager.Cancel(id);
    return threads;
  };
  EXPECT_EQ(threads_of_two(false), std::max(2, cores));
  EXPECT_EQ(threads_of_two(true), 2 * cores);
}

TEST_F(OwnersTest, JobsAreDeletedAfterTheirTimeUnlessTheyArePinned) {
  JobManager manager(*store_, BoxCodec(), Options(1));
  JobRecord with_ttl = JobOf("ann"), pinned = JobOf("bob");
  with_ttl.ttl_s = pinned.ttl_s = 1;
  pinned.is_pinned = true;
  const std::string kept = manager.Submit(pinned, nullptr).record.id;  // ends first
  WaitForEnd(manager, kept);
  const std::string gone = manager.Submit(with_ttl, nullptr).record.id;
  const std::string without = manager.Submit(JobOf("cid"), nullptr).record.id;
  const std::string deleted = "deleted, because it ended longer ago than jobs are kept";
  EXPECT_TRUE(Eventually([&] { return !events_.Of(deleted).empty(); }));
  EXPECT_THAT(events_.Of(deleted), ElementsAre("ann"));
  EXPECT_FALSE(manager.Get(gone));
  ASSERT_TRUE(manager.Get(kept));
  EXPECT_EQ(manager.Get(without)->record.state, JobState::kSucceeded);
  manager.ChangeSettings(kept, [](JobRecord& job) { job.is_pinned = false; });
  EXPECT_TRUE(Eventually([&] { return !manager.Get(kept); }));
  EXPECT_TRUE(manager.Get(without));
}

TEST_F(OwnersTest, FramesOfTheOldestFinishedJobsMakeRoom) {
  JobManagerOptions options = Options(1);
  std::vector<std::string> ids;
  {
    JobManager manager(*store_, BoxCodec(), options);
    for (int i = 0; i < 4; ++i) {
      JobRecord job = JobOf(std::string(1, static_cast<char>('a' + i)), {});
      job.is_pinned = i == 0;
      ids.push_back(manager.Submit(job, nullptr).record.id);
    }
    for (const std::string& id : ids) WaitForEnd(manager, id);
  }
  const std::int64_t each = store_->StoredBytesOf("a");
  ASSERT_EQ(store_->StoredBytesOf(std::nullopt), 4 * each);
  options.disk_budget = 3 * each - 1;
  const std::shared_ptr<FrameStore> read = store_->OpenFrames(ids[1]);  // somebody reads the frames of the first one
  JobManager manager(*store_, BoxCodec(), options);
  const std::string lost = "lost its frames, which were removed to make room";
  EXPECT_TRUE(Eventually([&] { return events_.Of(lost).size() == 2; }));
  EXPECT_THAT(events_.Of(lost), ElementsAre("c", "d"));
  EXPECT_EQ(store_->StoredBytesOf(std::nullopt), 2 * each);
  const JobRecord removed = manager.Get(ids[2])->record;
  EXPECT_EQ(removed.state, JobState::kSucceeded);
  EXPECT_EQ(removed.first_frame, 21);
  EXPECT_EQ(removed.frame_count, 21);
  EXPECT_EQ(removed.stored_bytes, 0);
  EXPECT_EQ(StoredDigests(*read), DigestsByCore({}));
  EXPECT_TRUE(manager.Verify(ids[2], {})->damages.empty());
  // They can be computed again.
  EXPECT_EQ(manager.Restart(ids[2], false), JobManager::RestartResult::kRestarted);
  EXPECT_TRUE(Eventually([&] { return manager.Get(ids[2])->record.attempt == 2; }));
  const JobView again = WaitForEnd(manager, ids[2]);
  EXPECT_EQ(again.record.state, JobState::kSucceeded);
  EXPECT_EQ(again.record.generation, 1);
}

TEST_F(OwnersTest, AssetsThatNoJobNamesAreRemovedAfterAnHour) {
  const auto put = [&](const std::string& text) {
    const std::string digest = Hex(Sha256Of(text));
    const auto upload = store_->BeginUpload(digest, static_cast<std::int64_t>(text.size()));
    upload->Write(text);
    EXPECT_TRUE(upload->Commit());
    return digest;
  };
  const std::string needed = put("needed"), unused = put("unused"), fresh = put("fresh");
  for (const std::string& old : {needed, unused}) {
    std::filesystem::last_write_time(directory_ / "assets/" + old.substr(0, 2) + "/" + old,
                                     std::filesystem::file_time_type::clock::now() - std::chrono::hours(2));
  }
  JobManagerOptions options = Options(1);
  std::atomic<int> notes = 0;
  options.on_note = [&](const std::string& note) { notes += note.find(unused) != std::string::npos; };
  JobCodec codec = BoxCodec();
  codec.assets_of = [&](const std::string&) { return std::set<std::string>{needed}; };
  JobRecord existing, job = BoxJob({});
  job.id = "00000000000000000000000001";
  job.state = JobState::kSucceeded;
  store_->CreateJob(job, &existing);
  JobManager manager(*store_, codec, options);
  EXPECT_TRUE(Eventually([&] { return notes == 1; }));
  EXPECT_FALSE(store_->HasAsset(unused));
  EXPECT_TRUE(store_->HasAsset(needed));
  EXPECT_TRUE(store_->HasAsset(fresh));
}

}  // namespace
}  // namespace fascicle::server
