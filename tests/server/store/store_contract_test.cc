// Every clause of server/store/store.h, for each store.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <iterator>
#include <numeric>
#include <random>
#include <set>
#include <span>
#include <stdexcept>
#include <thread>

#include "server/store/store.h"
#include "tests/support/files.h"
#include "tests/support/store_samples.h"

namespace fascicle::server {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

enum class Kind { kMemory, kSqlite };

class StoreContract : public ::testing::TestWithParam<Kind> {
 protected:
  std::unique_ptr<Store> Make() {
    return GetParam() == Kind::kMemory ? MakeMemoryStore() : OpenSqliteStore(directory_.path());
  }
  std::shared_ptr<FrameStore> MakeFrames() {
    store_->CreateJob(SampleJob(1), &existing_);
    return store_->OpenFrames(SampleJob(1).id);
  }
  static std::vector<std::string> Names(const std::vector<JobRecord>& jobs) {
    std::vector<std::string> names;
    for (const JobRecord& job : jobs) names.push_back(job.scene_name.substr(job.scene_name.size() - 2));
    return names;
  }

  testing::TemporaryFolder directory_;
  std::unique_ptr<Store> store_ = Make();
  JobRecord existing_;
};

void ExpectEqual(const JobRecord& a, const JobRecord& b) {
  EXPECT_EQ(a.id, b.id);
  EXPECT_EQ(a.request_id, b.request_id);
  EXPECT_EQ(a.request_digest, b.request_digest);
  EXPECT_EQ(a.scene_name, b.scene_name);
  EXPECT_EQ(a.spec, b.spec);
  EXPECT_EQ(a.threads, b.threads);
  EXPECT_EQ(a.state, b.state);
  EXPECT_EQ(a.failure, b.failure);
  EXPECT_EQ(a.profile, b.profile);
  EXPECT_EQ(a.attempt, b.attempt);
  EXPECT_EQ(a.generation, b.generation);
  EXPECT_EQ(a.create_time_us, b.create_time_us);
  EXPECT_EQ(a.start_time_us, b.start_time_us);
  EXPECT_EQ(a.end_time_us, b.end_time_us);
  EXPECT_EQ(a.fraction, b.fraction);
  EXPECT_EQ(a.time, b.time);
  EXPECT_EQ(a.step, b.step);
  EXPECT_EQ(a.frame_count, b.frame_count);
  EXPECT_EQ(a.stored_bytes, b.stored_bytes);
  EXPECT_EQ(a.owner, b.owner);
  EXPECT_EQ(a.labels, b.labels);
  EXPECT_EQ(a.priority, b.priority);
  EXPECT_EQ(a.ttl_s, b.ttl_s);
  EXPECT_EQ(a.is_pinned, b.is_pinned);
  EXPECT_EQ(a.first_frame, b.first_frame);
}

TEST_P(StoreContract, KeepsEveryFieldOfAJob) {
  JobRecord job = SampleJob(1);
  job.request_id = "a request";
  job.owner = "ann";
  job.labels = {{"a", ""}, {"b.c", "x = y"}};
  job.priority = -3;
  job.ttl_s = 12;
  job.is_pinned = true;
  job.first_frame = 4;
  ASSERT_TRUE(store_->CreateJob(job, &existing_));
  ExpectEqual(store_->GetJob(job.id).value(), job);
  ExpectEqual(store_->FindRequest("a request").value(), job);
  EXPECT_FALSE(store_->FindRequest("another").has_value());
  EXPECT_FALSE(store_->FindRequest("").has_value());
}

// State and settings are changed by different threads, each of which has read the record before.
TEST_P(StoreContract, UpdatesOfStateAndSettingsDoNotUndoEachOther) {
  JobRecord job = SampleJob(1);
  job.owner = "ann";
  ASSERT_TRUE(store_->CreateJob(job, &existing_));
  JobRecord state = job, settings = job;
  state.state = JobState::kRunning;
  settings.labels = {{"a", "b"}};
  settings.priority = 7;
  settings.is_pinned = true;
  settings.ttl_s = 60;
  store_->UpdateJob(state);
  EXPECT_TRUE(store_->UpdateSettings(settings));
  state.frame_count = 3;
  store_->UpdateJob(state);
  const JobRecord found = *store_->GetJob(job.id);
  EXPECT_EQ(found.state, JobState::kRunning);
  EXPECT_EQ(found.frame_count, 3);
  EXPECT_EQ(found.labels, settings.labels);
  EXPECT_EQ(found.priority, 7);
  EXPECT_TRUE(found.is_pinned);
  EXPECT_EQ(found.ttl_s, 60);
  EXPECT_EQ(found.owner, "ann");
  EXPECT_FALSE(store_->UpdateSettings(SampleJob(2)));
}

constexpr const char* kKeys[] = {"l", "kl", "l.k", "m"};  // parts of each other

// A job whose fields are chosen at random from few values, so that many jobs are equal in some.
JobRecord RandomJob(int number, std::mt19937& random) {
  JobRecord job = SampleJob(number);
  const auto pick = [&](unsigned count) { return static_cast<int>(random() % count); };
  job.state = static_cast<JobState>(1 + pick(9));
  job.owner = std::string(1, static_cast<char>('a' + pick(3)));
  job.scene_name = std::string(1, static_cast<char>('p' + pick(3))) + "%_'\"";
  for (int i = pick(3); i > 0; --i) job.labels[kKeys[pick(3)]] = std::to_string(pick(2));
  job.priority = pick(3) - 1;
  job.start_time_us = pick(3) * 10;
  job.end_time_us = pick(3) * 20;
  job.ttl_s = pick(3);
  job.stored_bytes = pick(4);
  job.frame_count = pick(4);
  job.is_pinned = pick(2) == 1;
  return job;
}

JobCondition RandomCondition(std::mt19937& random) {
  const auto pick = [&](unsigned count) { return static_cast<int>(random() % count); };
  JobCondition condition;
  condition.field = static_cast<JobField>(1 + pick(13));
  condition.relation = static_cast<JobCondition::Relation>(pick(6));
  condition.number = pick(4) * (pick(2) == 0 ? 1 : 10);
  condition.is_negated = pick(4) == 0;
  if (condition.field == JobField::kCreated) condition.number = SampleJob(pick(80)).create_time_us;
  if (condition.field == JobField::kOwner) condition.text = std::string(1, static_cast<char>('a' + pick(4)));
  if (condition.field == JobField::kName) condition.text = pick(2) == 0 ? "p%_'\"" : "_'";
  if (IsText(condition.field)) condition.relation = static_cast<JobCondition::Relation>(pick(2));
  if (IsText(condition.field) && pick(3) == 0) condition.relation = JobCondition::Relation::kContains;
  if (condition.field == JobField::kLabel) {
    condition.key = kKeys[pick(4)];
    condition.text = std::to_string(pick(3));
  }
  return condition;
}

// Random filters and orders, by pages, against a look at every job.
TEST_P(StoreContract, FindsTheJobsThatPassInTheirOrder) {
  constexpr JobField kOrders[] = {JobField::kId,       JobField::kStarted,     JobField::kEnded,
                                  JobField::kPriority, JobField::kStoredBytes, JobField::kFrames,
                                  JobField::kOwner,    JobField::kName,        JobField::kState};
  std::mt19937 random(17);
  std::vector<JobRecord> jobs;
  for (int i = 0; i < 80; ++i) {
    jobs.push_back(RandomJob(i, random));
    ASSERT_TRUE(store_->CreateJob(jobs.back(), &existing_));
  }
  std::size_t found_at_all = 0;
  for (int round = 0; round < 150; ++round) {
    JobQuery query;
    for (auto groups = random() % 3; groups > 0; --groups) {
      query.filter.groups.emplace_back();
      for (auto terms = 1 + random() % 3; terms > 0; --terms) {
        query.filter.groups.back().push_back(RandomCondition(random));
      }
    }
    query.order = kOrders[random() % std::size(kOrders)];
    query.is_descending = random() % 2 == 0;
    query.limit = 7;
    std::vector<JobPlace> expected;
    for (const JobRecord& job : jobs) {
      if (query.filter.Passes(job)) expected.push_back(PlaceOf(job, query.order));
    }
    std::sort(expected.begin(), expected.end(),
              [&](const JobPlace& a, const JobPlace& b) { return IsBefore(query, a, b); });
    std::vector<std::string> expected_ids, found_ids;
    for (const JobPlace& place : expected) expected_ids.push_back(place.id);
    while (true) {
      const std::vector<JobRecord> page = store_->FindJobs(query);
      for (const JobRecord& job : page) found_ids.push_back(job.id);
      if (page.size() < 7) break;
      query.after = PlaceOf(page.back(), query.order);
      EXPECT_EQ(page.back().spec, "");
    }
    EXPECT_EQ(found_ids, expected_ids) << "round " << round;
    found_at_all += found_ids.size();
  }
  EXPECT_GT(found_at_all, 2000u);
  EXPECT_EQ(store_->StoredBytesOf("b"),
            std::accumulate(jobs.begin(), jobs.end(), std::int64_t{0},
                            [](auto sum, auto& job) { return sum + (job.owner == "b" ? job.stored_bytes : 0); }));
  EXPECT_GT(store_->StoredBytesOf(std::nullopt), store_->StoredBytesOf("b"));
}

TEST_P(StoreContract, TellsEveryChangeAfterARevision) {
  const auto ids = [](const std::vector<JobRecord>& jobs) {
    std::vector<std::string> names;
    for (const JobRecord& job : jobs) names.push_back(job.id);
    return names;
  };
  for (int i = 1; i <= 4; ++i) store_->CreateJob(SampleJob(i), &existing_);
  const std::int64_t begin = store_->Revision();
  JobChanges all = *store_->ChangesAfter(0, 0, 100);
  EXPECT_THAT(ids(all.changed), ElementsAre(SampleJob(1).id, SampleJob(2).id, SampleJob(3).id, SampleJob(4).id));
  EXPECT_EQ(all.revision, begin);
  EXPECT_EQ(all.changed.front().spec, "");
  store_->UpdateJob(SampleJob(3));
  store_->DeleteJob(SampleJob(2).id);
  store_->UpdateSettings(SampleJob(1));
  const JobChanges later = *store_->ChangesAfter(begin, 0, 100);
  EXPECT_THAT(ids(later.changed), ElementsAre(SampleJob(3).id, SampleJob(1).id));
  EXPECT_THAT(later.deleted, ElementsAre(SampleJob(2).id));
  EXPECT_EQ(later.revision, store_->Revision());
  EXPECT_EQ(later.changed.back().revision, store_->Revision());
  // In parts: each change once, in order.
  const JobChanges part = *store_->ChangesAfter(begin, 0, 1);
  EXPECT_THAT(ids(part.changed), ElementsAre(SampleJob(3).id));
  EXPECT_THAT(part.deleted, IsEmpty());
  const JobChanges rest = *store_->ChangesAfter(part.revision, 0, 100);
  EXPECT_THAT(ids(rest.changed), ElementsAre(SampleJob(1).id));
  EXPECT_THAT(rest.deleted, ElementsAre(SampleJob(2).id));
  // Who begins anew need not hear of deletions before.
  EXPECT_THAT(store_->ChangesAfter(0, store_->Revision(), 100)->deleted, IsEmpty());
  EXPECT_THAT(store_->ChangesAfter(store_->Revision(), 0, 100)->changed, IsEmpty());
  EXPECT_FALSE(store_->ChangesAfter(store_->Revision() + 1, 0, 100).has_value());
}

TEST_P(StoreContract, FramesCanBeRemovedWhenNobodyReadsThem) {
  std::shared_ptr<FrameStore> frames = MakeFrames();
  const SampleFrame frame = MakeSampleFrame(0, 100);
  frames->PutFrame(frame.record, frame.bytes, "checkpoint");
  SteeringRecord input;
  input.sequence = 1;
  input.step = 7;
  input.input = "an input";
  frames->PutSteering(input);
  JobRecord job = SampleJob(1);
  job.frame_count = job.first_frame = 1;
  EXPECT_FALSE(store_->RemoveFrames(job));
  EXPECT_EQ(store_->GetJob(job.id)->first_frame, 0);
  EXPECT_EQ(ReadFrame(*frames, 0), frame.bytes);
  frames.reset();
  EXPECT_TRUE(store_->RemoveFrames(job));
  EXPECT_EQ(store_->GetJob(job.id)->first_frame, 1);
  EXPECT_EQ(store_->OpenFrames(job.id)->frame_count(), 0);
  EXPECT_FALSE(NewestCheckpoint(*store_->OpenFrames(job.id)).has_value());
  // Without its inputs, a restart would compute other frames.
  const std::vector<SteeringRecord> inputs = store_->OpenFrames(job.id)->ListSteering(0, 10);
  ASSERT_EQ(inputs.size(), 1u);
  EXPECT_EQ(inputs[0].step, 7);
  EXPECT_EQ(inputs[0].input, "an input");
  if (GetParam() == Kind::kMemory) return;
  store_.reset();
  store_ = Make();
  EXPECT_EQ(store_->OpenFrames(job.id)->frame_count(), 0);
  EXPECT_EQ(store_->OpenFrames(job.id)->ListSteering(0, 10).size(), 1u);
}

TEST_P(StoreContract, KnowsNoJobThatWasNotCreated) {
  EXPECT_FALSE(store_->GetJob("nobody").has_value());
  EXPECT_EQ(store_->OpenFrames("nobody"), nullptr);
  EXPECT_FALSE(store_->DeleteJob("nobody"));
  EXPECT_THAT(store_->ListJobs(10, "", {}), IsEmpty());
  store_->UpdateJob(SampleJob(1));
  EXPECT_FALSE(store_->GetJob(SampleJob(1).id).has_value());
}

TEST_P(StoreContract, GivesTheEarlierJobForARequestIdThatIsTaken) {
  JobRecord first = SampleJob(1), second = SampleJob(2);
  first.request_id = second.request_id = "same";
  second.request_digest = first.request_digest;
  ASSERT_TRUE(store_->CreateJob(first, &existing_));
  EXPECT_FALSE(store_->CreateJob(second, &existing_));
  ExpectEqual(existing_, first);
  EXPECT_FALSE(store_->GetJob(second.id).has_value());
  // Jobs without a request id never conflict.
  EXPECT_TRUE(store_->CreateJob(SampleJob(3), &existing_));
  EXPECT_TRUE(store_->CreateJob(SampleJob(4), &existing_));
  // The request id of a deleted job can be reused.
  ASSERT_TRUE(store_->DeleteJob(first.id));
  EXPECT_TRUE(store_->CreateJob(second, &existing_));
}

TEST_P(StoreContract, CreatesManyJobsOrNone) {
  std::vector<JobRecord> jobs = {SampleJob(1), SampleJob(2), SampleJob(3)};
  for (JobRecord& job : jobs) job.request_id = "request of " + job.id;
  jobs[1].request_id = "";
  const std::vector<std::optional<JobRecord>> first = store_->CreateJobs(std::span(jobs).first(2));
  EXPECT_EQ(first.size(), 2U);
  EXPECT_FALSE(first[0] || first[1]);
  // A repetition beside a new one. Each has its own revision, so that changes can be listed by parts.
  const std::vector<JobRecord> again = {jobs[0], jobs[2]};
  const std::vector<std::optional<JobRecord>> second = store_->CreateJobs(again);
  ASSERT_TRUE(second[0]);
  ExpectEqual(*second[0], jobs[0]);
  EXPECT_FALSE(second[1]);
  std::set<std::int64_t> revisions;
  for (const JobRecord& job : jobs) revisions.insert(store_->GetJob(job.id).value().revision);
  EXPECT_EQ(revisions.size(), 3U);
  EXPECT_EQ(*revisions.rbegin(), store_->Revision());
  // A request id of another job refuses all.
  std::vector<JobRecord> others = {SampleJob(4), SampleJob(5)};
  others[1].request_id = jobs[0].request_id;
  others[1].request_digest = "another";
  try {
    store_->CreateJobs(others);
    ADD_FAILURE() << "a request id was used twice";
  } catch (const RequestReusedError& error) {
    EXPECT_EQ(error.job_id(), jobs[0].id);
  }
  EXPECT_FALSE(store_->GetJob(others[0].id).has_value());
  EXPECT_EQ(store_->ListJobs(10, "", {}).size(), 3U);
}

TEST_P(StoreContract, ConcurrentSubmissionsMakeOneJobForEachRequestId) {
  constexpr int kThreads = 8, kRequests = 60, kRepeats = 8;
  std::atomic<int> created = 0, wrong = 0, number = 0;
  std::vector<std::thread> threads;
  for (int t = 0; t < kThreads; ++t) {
    threads.emplace_back([&, t] {
      for (int i = 0; i < kRequests * kRepeats / kThreads; ++i) {
        JobRecord job = SampleJob(number++);
        job.request_id = "request " + std::to_string((i * 7 + t) % kRequests);
        job.request_digest = "digest of " + job.request_id;
        JobRecord existing;
        const bool is_new = store_->CreateJob(job, &existing);
        created += is_new;
        wrong += !is_new && existing.request_id != job.request_id;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  const std::vector<JobRecord> jobs = store_->ListJobs(10'000, "", {});
  std::set<std::string> requests;
  for (const JobRecord& job : jobs) requests.insert(job.request_id);
  EXPECT_EQ(created, kRequests);
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(jobs.size(), std::size_t{kRequests});
  EXPECT_EQ(requests.size(), std::size_t{kRequests});
}

TEST_P(StoreContract, ListsNewestFirstByPageAndState) {
  for (int i : {3, 1, 2, 5, 4}) {
    JobRecord job = SampleJob(i);
    job.state = i % 2 == 0 ? JobState::kRunning : JobState::kFailed;
    store_->CreateJob(job, &existing_);
  }
  EXPECT_THAT(Names(store_->ListJobs(10, "", {})), ElementsAre("05", "04", "03", "02", "01"));
  EXPECT_THAT(Names(store_->ListJobs(2, "", {})), ElementsAre("05", "04"));
  EXPECT_THAT(Names(store_->ListJobs(2, SampleJob(4).id, {})), ElementsAre("03", "02"));
  EXPECT_THAT(Names(store_->ListJobs(10, SampleJob(5).id, {JobState::kFailed})), ElementsAre("03", "01"));
  EXPECT_THAT(Names(store_->ListJobs(10, "", {JobState::kRunning, JobState::kQueued})), ElementsAre("04", "02"));
  EXPECT_THAT(store_->ListJobs(0, "", {}), IsEmpty());
  EXPECT_EQ(store_->ListJobs(1, "", {}).front().spec, "");
}

TEST_P(StoreContract, UpdatesWhatARunChangesAndNothingElse) {
  JobRecord job = SampleJob(1);
  job.request_id = "r";
  store_->CreateJob(job, &existing_);
  JobRecord changed = job;
  changed.state = JobState::kFailed;
  changed.failure = std::string("why\0not", 7);
  changed.profile = std::string("where\0to", 8);
  changed.attempt = 2;
  changed.generation = 4;
  changed.start_time_us = 5;
  changed.end_time_us = 6;
  changed.fraction = 0.7;
  changed.time = 0.3;
  changed.step = 8;
  changed.frame_count = 9;
  changed.stored_bytes = 10;
  JobRecord sent = changed;
  sent.spec = sent.scene_name = sent.request_id = sent.request_digest = "something else";
  sent.threads = 77;
  sent.create_time_us = 1;
  store_->UpdateJob(sent);
  ExpectEqual(store_->GetJob(job.id).value(), changed);
}

TEST_P(StoreContract, DeletesAJobWithItsFrames) {
  const std::shared_ptr<FrameStore> frames = MakeFrames();
  const SampleFrame frame = MakeSampleFrame(0, 100);
  frames->PutFrame(frame.record, frame.bytes, "c");
  EXPECT_TRUE(store_->DeleteJob(SampleJob(1).id));
  EXPECT_FALSE(store_->DeleteJob(SampleJob(1).id));
  EXPECT_FALSE(store_->GetJob(SampleJob(1).id).has_value());
  EXPECT_EQ(store_->OpenFrames(SampleJob(1).id), nullptr);
}

TEST_P(StoreContract, FramesStayUsableUntilReleasedWhenTheJobIsDeleted) {
  const std::shared_ptr<FrameStore> frames = MakeFrames();
  for (int i = 0; i < 3; ++i) {
    const SampleFrame frame = MakeSampleFrame(i, 5000);
    frames->PutFrame(frame.record, frame.bytes, "");
  }
  store_->DeleteJob(SampleJob(1).id);
  std::vector<std::thread> readers;  // more concurrent ones than there were connections before
  for (int t = 0; t < 4; ++t) {
    readers.emplace_back([&] {
      for (int i = 0; i < 3; ++i) EXPECT_EQ(ReadFrame(*frames, i), MakeSampleFrame(i, 5000).bytes);
    });
  }
  for (std::thread& reader : readers) reader.join();
  const SampleFrame next = MakeSampleFrame(3, 5000);
  frames->PutFrame(next.record, next.bytes, "");
  EXPECT_EQ(frames->frame_count(), 4);
}

TEST_P(StoreContract, AJobHasOneFrameStore) {
  const std::shared_ptr<FrameStore> frames = MakeFrames();
  EXPECT_EQ(frames, store_->OpenFrames(SampleJob(1).id));
}

TEST_P(StoreContract, FramesOutliveTheStore) {
  std::shared_ptr<FrameStore> frames = MakeFrames();
  store_.reset();
  const SampleFrame frame = MakeSampleFrame(0, 100);
  frames->PutFrame(frame.record, frame.bytes, "");
  EXPECT_EQ(ReadFrame(*frames, 0), frame.bytes);
}

TEST_P(StoreContract, KeepsGeometryOfAnySize) {
  const std::shared_ptr<FrameStore> frames = MakeFrames();
  EXPECT_FALSE(ReadGeometry(*frames).has_value());
  for (std::size_t size : {std::size_t{0}, std::size_t{10}, std::size_t{FrameStore::kChunkSize},
                           std::size_t{3 * FrameStore::kChunkSize + 1}, std::size_t{5}}) {
    frames->PutGeometry(SampleBytes(size, size));
    EXPECT_EQ(ReadGeometry(*frames).value(), SampleBytes(size, size));
    EXPECT_EQ(frames->stored_bytes(), static_cast<std::int64_t>(size));
  }
}

TEST_P(StoreContract, KeepsFramesInChunks) {
  const std::shared_ptr<FrameStore> frames = MakeFrames();
  const std::vector<std::size_t> sizes = {0, 1, FrameStore::kChunkSize - 1, FrameStore::kChunkSize,
                                          2 * FrameStore::kChunkSize + 5};
  std::int64_t total = 0;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const SampleFrame frame = MakeSampleFrame(static_cast<std::int64_t>(i), sizes[i]);
    EXPECT_FALSE(frames->PutFrame(frame.record, frame.bytes, ""));
    total += static_cast<std::int64_t>(sizes[i]);
  }
  EXPECT_EQ(frames->frame_count(), 5);
  EXPECT_EQ(frames->stored_bytes(), total);
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const auto index = static_cast<std::int64_t>(i);
    EXPECT_EQ(ReadFrame(*frames, index), MakeSampleFrame(index, sizes[i]).bytes);
    EXPECT_TRUE(frames->ReadChunk(index, 0).has_value());
  }
  EXPECT_EQ(frames->ReadChunk(4, 0)->size(), std::size_t{FrameStore::kChunkSize});
  EXPECT_EQ(frames->ReadChunk(4, 2)->size(), 5u);
  EXPECT_FALSE(frames->ReadChunk(4, 3).has_value());
  EXPECT_FALSE(frames->ReadChunk(3, 1).has_value());
  EXPECT_FALSE(frames->ReadChunk(5, 0).has_value());
  EXPECT_FALSE(frames->ReadChunk(-1, 0).has_value());
  EXPECT_FALSE(frames->ReadChunk(0, -1).has_value());
}

TEST_P(StoreContract, ListsFramesFromAnIndex) {
  const std::shared_ptr<FrameStore> frames = MakeFrames();
  for (int i = 0; i < 5; ++i) frames->PutFrame(MakeSampleFrame(i, 10).record, MakeSampleFrame(i, 10).bytes, "");
  const std::vector<FrameRecord> listed = frames->ListFrames(2, 2);
  ASSERT_EQ(listed.size(), 2u);
  EXPECT_TRUE(listed[0] == MakeSampleFrame(2, 10).record);
  EXPECT_TRUE(listed[1] == MakeSampleFrame(3, 10).record);
  EXPECT_EQ(frames->ListFrames(-3, 100).size(), 5u);
  EXPECT_THAT(frames->ListFrames(5, 100), IsEmpty());
  EXPECT_THAT(frames->ListFrames(0, 0), IsEmpty());
}

TEST_P(StoreContract, KeepsTheLastTwoCheckpoints) {
  const std::shared_ptr<FrameStore> frames = MakeFrames();
  EXPECT_FALSE(NewestCheckpoint(*frames).has_value());
  const auto put = [&](int i, std::string_view checkpoint) {
    return frames->PutFrame(MakeSampleFrame(i, 10).record, MakeSampleFrame(i, 10).bytes, checkpoint);
  };
  put(0, "first");
  put(1, "");
  EXPECT_EQ(NewestCheckpoint(*frames), "first");
  put(2, std::string_view("sec\0nd", 6));
  EXPECT_EQ(NewestCheckpoint(*frames), std::string_view("sec\0nd", 6));
  // Writing the same frame again keeps the later frames and their checkpoint.
  EXPECT_FALSE(put(1, "again"));
  EXPECT_EQ(NewestCheckpoint(*frames), std::string_view("sec\0nd", 6));
  EXPECT_EQ(frames->GetCheckpoint(2)->bytes, "again");
  EXPECT_EQ(frames->GetCheckpoint(2)->frame, 1);
  EXPECT_FALSE(frames->GetCheckpoint(1).has_value()) << "only the last two are kept";
  EXPECT_EQ(frames->frame_count(), 3);
}

TEST_P(StoreContract, AFrameWithAnotherDigestReplacesItAndAllLaterOnes) {
  const std::shared_ptr<FrameStore> frames = MakeFrames();
  for (int i = 0; i < 4; ++i) {
    frames->PutFrame(MakeSampleFrame(i, 100).record, MakeSampleFrame(i, 100).bytes, i == 2 ? "of frame 2" : "");
  }
  const SampleFrame other = MakeSampleFrame(1, 60, 9);
  EXPECT_TRUE(frames->PutFrame(other.record, other.bytes, ""));
  EXPECT_EQ(frames->frame_count(), 2);
  EXPECT_EQ(frames->stored_bytes(), 160);
  EXPECT_EQ(ReadFrame(*frames, 0), MakeSampleFrame(0, 100).bytes);
  EXPECT_EQ(ReadFrame(*frames, 1), other.bytes);
  EXPECT_FALSE(frames->ReadChunk(2, 0).has_value());
  // The checkpoint belongs to frames that have been removed.
  EXPECT_FALSE(NewestCheckpoint(*frames).has_value());
}

TEST_P(StoreContract, RefusesAFrameThatLeavesAGap) {
  const std::shared_ptr<FrameStore> frames = MakeFrames();
  EXPECT_THROW(frames->PutFrame(MakeSampleFrame(1, 10).record, "x", ""), std::invalid_argument);
  EXPECT_THROW(frames->PutFrame(MakeSampleFrame(-1, 10).record, "x", ""), std::invalid_argument);
  EXPECT_EQ(frames->frame_count(), 0);
}

TEST_P(StoreContract, ReadersGoOnWhileFramesAreWritten) {
  const std::shared_ptr<FrameStore> frames = MakeFrames();
  constexpr int kFrames = 40;
  constexpr std::size_t kSize = 50'000;
  std::atomic<int> wrong = 0;
  std::vector<std::thread> readers;
  for (int t = 0; t < 3; ++t) {
    readers.emplace_back([&] {
      for (std::int64_t next = 0; next < kFrames;) {
        const std::int64_t count = frames->frame_count();
        wrong += static_cast<std::int64_t>(frames->ListFrames(0, 1000).size()) < count;
        for (; next < count; ++next) wrong += ReadFrame(*frames, next) != MakeSampleFrame(next, kSize).bytes;
      }
    });
  }
  for (int i = 0; i < kFrames; ++i) {
    const SampleFrame frame = MakeSampleFrame(i, kSize);
    frames->PutFrame(frame.record, frame.bytes, SampleBytes(1, 1000));
  }
  for (std::thread& reader : readers) reader.join();
  EXPECT_EQ(wrong, 0);
}

std::vector<LogRow> LinesOf(int first, int end, const std::string& text = "line ") {
  std::vector<LogRow> lines;
  for (int number = first; number < end; ++number) lines.push_back({number, text + std::to_string(number)});
  return lines;
}

std::string TextOf(FrameStore& frames, std::int64_t number) {
  const std::vector<LogRow> lines = frames.ReadLog(number, 1);
  return lines.empty() || lines[0].number != number ? "missing" : lines[0].bytes;
}

TEST_P(StoreContract, ARepeatedLineOfTheLogIsStoredOnce) {
  const std::shared_ptr<FrameStore> frames = MakeFrames();
  EXPECT_EQ(frames->log_end(), 0);
  const SampleFrame first = MakeSampleFrame(0, 10), second = MakeSampleFrame(1, 10);
  frames->PutFrame(first.record, first.bytes, "", LinesOf(0, 5));
  frames->PutLog(LinesOf(5, 8));
  EXPECT_EQ(frames->log_end(), 8);
  // As a run writes them again from a checkpoint: with the frame, and beyond what was stored.
  frames->PutFrame(first.record, first.bytes, "", LinesOf(2, 5));
  EXPECT_EQ(frames->log_end(), 8);
  frames->PutFrame(second.record, second.bytes, "", LinesOf(5, 11));
  ASSERT_EQ(frames->ReadLog(0, 100).size(), 11u);
  for (int k = 0; k < 11; ++k) EXPECT_EQ(TextOf(*frames, k), "line " + std::to_string(k));
  EXPECT_EQ(frames->ReadLog(4, 3).size(), 3u);
  frames->PutLog(LinesOf(6, 8, "other "));
  EXPECT_EQ(frames->log_end(), 8) << "later ones belong to the other course";
  EXPECT_EQ(TextOf(*frames, 5), "line 5");
  EXPECT_EQ(TextOf(*frames, 6), "other 6");
}

TEST_P(StoreContract, KeepsTheFirstAndTheLastLinesOfALog) {
  const std::shared_ptr<FrameStore> frames = MakeFrames();
  constexpr int kEnd = 30'000;
  frames->PutLog(LinesOf(0, 10'000));
  frames->PutLog(LinesOf(10'000, kEnd));
  const std::vector<LogRow> kept = frames->ReadLog(0, 1 << 20);
  ASSERT_EQ(static_cast<std::int64_t>(kept.size()), FrameStore::kFirstLines + FrameStore::kLastLines);
  EXPECT_EQ(TextOf(*frames, 999), "line 999");
  EXPECT_EQ(TextOf(*frames, 1000), "missing");
  EXPECT_EQ(TextOf(*frames, 10'000), "line 10000");
  frames->PutLog(LinesOf(5'000, kEnd));  // again, from before what was removed
  EXPECT_EQ(frames->log_end(), kEnd);
  EXPECT_EQ(frames->ReadLog(0, 1 << 20).size(), kept.size());
}

TEST_P(StoreContract, KeepsInputs) {
  const std::shared_ptr<FrameStore> frames = MakeFrames();
  EXPECT_THAT(frames->ListSteering(1, 10), IsEmpty());
  frames->PutSteering({1, 17, std::nullopt, 5, std::string("a\0b", 3)});
  frames->PutSteering({2, std::nullopt, 0.25, 6, "later"});
  std::vector<SteeringRecord> listed = frames->ListSteering(1, 10);
  ASSERT_EQ(listed.size(), 2u);
  EXPECT_EQ(listed[0].step, 17);
  EXPECT_FALSE(listed[0].time.has_value());
  EXPECT_EQ(listed[0].accept_time_us, 5);
  EXPECT_EQ(listed[0].input, std::string("a\0b", 3));
  EXPECT_FALSE(listed[1].step.has_value());
  EXPECT_EQ(listed[1].time, 0.25);
  listed[1].step = 40;
  frames->PutSteering(listed[1]);
  EXPECT_EQ(frames->ListSteering(2, 10).size(), 1u);
  EXPECT_EQ(frames->ListSteering(2, 10)[0].step, 40);
  EXPECT_EQ(frames->ListSteering(1, 1).size(), 1u);
}

INSTANTIATE_TEST_SUITE_P(Stores, StoreContract, ::testing::Values(Kind::kMemory, Kind::kSqlite),
                         [](const auto& test) { return test.param == Kind::kMemory ? "Memory" : "Sqlite"; });

}  // namespace
}  // namespace fascicle::server
