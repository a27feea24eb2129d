// The store on disk: it survives the process, and handles defective files and full disks.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <map>
#include <thread>

#include "server/store/database.h"
#include "server/store/frame_database.h"
#include "server/store/group_commit.h"
#include "server/store/job_tables.h"
#include "server/store/store.h"
#include "tests/support/files.h"
#include "tests/support/store_samples.h"

namespace fascicle::server {
namespace {

namespace fs = std::filesystem;

class SqliteStoreTest : public ::testing::Test {
 protected:
  std::unique_ptr<Store> Open() { return OpenSqliteStore(directory_.path()); }
  std::string FramesPath(int job) { return directory_ / "jobs/" + SampleJob(job).id + ".db"; }
  void Fill(Store& store, int job, int frames, std::size_t size) {
    store.CreateJob(SampleJob(job), &existing_);
    const std::shared_ptr<FrameStore> open = store.OpenFrames(SampleJob(job).id);
    for (int i = 0; i < frames; ++i) {
      const SampleFrame frame = MakeSampleFrame(i, size);
      open->PutFrame(frame.record, frame.bytes, "checkpoint " + std::to_string(i));
    }
  }
  bool AreFilesOf(int job) {
    for (const auto& entry : fs::directory_iterator(directory_ / "jobs")) {
      if (entry.path().filename().string().starts_with(SampleJob(job).id)) return true;
    }
    return false;
  }

  testing::TemporaryFolder directory_;
  JobRecord existing_;
};

// Frames are removed in three steps; the server may be killed between any two.
TEST_F(SqliteStoreTest, AnInterruptedRemovalOfFramesIsFinishedIfItWasRecorded) {
  for (const bool has_inputs : {true, false}) {
    SCOPED_TRACE(has_inputs);
    const int number = has_inputs ? 1 : 2;
    JobRecord job = SampleJob(number);
    {
      const std::unique_ptr<Store> store = Open();
      Fill(*store, number, 3, 100'000);
      if (has_inputs) store->OpenFrames(job.id)->PutSteering({1, 7, {}, 0, "an input"});
    }
    FrameDatabase::CopyInputs(FramesPath(number));
    EXPECT_EQ(Open()->OpenFrames(job.id)->frame_count(), 3);
    EXPECT_FALSE(fs::exists(FramesPath(number) + FrameDatabase::kInputsSuffix));

    job.first_frame = job.frame_count = 3;
    Open()->UpdateJob(job);
    FrameDatabase::CopyInputs(FramesPath(number));
    const std::unique_ptr<Store> store = Open();
    EXPECT_EQ(AreFilesOf(number), has_inputs);
    EXPECT_EQ(store->OpenFrames(job.id)->frame_count(), 0);
    EXPECT_EQ(store->OpenFrames(job.id)->ListSteering(0, 10).size(), has_inputs ? 1u : 0u);
  }
}

TEST_F(SqliteStoreTest, EverythingIsThereAfterReopening) {
  {
    const std::unique_ptr<Store> store = Open();
    Fill(*store, 1, 3, 2'000'000);
    store->OpenFrames(SampleJob(1).id)->PutGeometry(SampleBytes(9, 1'500'000));
    JobRecord job = SampleJob(1);
    job.state = JobState::kRunning;
    store->UpdateJob(job);
  }
  const std::unique_ptr<Store> store = Open();
  EXPECT_EQ(store->GetJob(SampleJob(1).id)->state, JobState::kRunning);
  EXPECT_EQ(store->GetJob(SampleJob(1).id)->spec, SampleJob(1).spec);
  const std::shared_ptr<FrameStore> frames = store->OpenFrames(SampleJob(1).id);
  EXPECT_EQ(frames->frame_count(), 3);
  EXPECT_EQ(frames->stored_bytes(), 7'500'000);
  EXPECT_EQ(ReadGeometry(*frames), SampleBytes(9, 1'500'000));
  EXPECT_EQ(NewestCheckpoint(*frames), "checkpoint 2");
  for (int i = 0; i < 3; ++i) EXPECT_EQ(ReadFrame(*frames, i), MakeSampleFrame(i, 2'000'000).bytes);
}

TEST_F(SqliteStoreTest, IsUsedByOneAtATime) {
  std::unique_ptr<Store> store = Open();
  EXPECT_NE(ErrorOf([&] { Open(); }).find("in use"), std::string::npos);
  const pid_t child = fork();
  if (child == 0) _exit(ErrorOf([&] { Open(); }).empty() ? 1 : 0);
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
  // The directory exists as long as frames are in use.
  store->CreateJob(SampleJob(1), &existing_);
  std::shared_ptr<FrameStore> frames = store->OpenFrames(SampleJob(1).id);
  store.reset();
  EXPECT_NE(ErrorOf([&] { Open(); }), "");
  frames.reset();
  EXPECT_EQ(ErrorOf([&] { Open(); }), "");
}

TEST_F(SqliteStoreTest, RefusesDataOfANewerVersion) {
  { Open(); }
  for (const char* file : {"control.db", "control.copy.db"}) {
    Database(directory_ / file, Database::Mode::kReadWrite).Execute("PRAGMA user_version = 99");
  }
  EXPECT_NE(ErrorOf([&] { Open(); }).find("newer version"), std::string::npos);
}

// control.db in format 1: its jobs have no profile, and get one.
TEST_F(SqliteStoreTest, JobsOfFormat1AreTakenOver) {
  static constexpr std::array<const char*, 1> kFormat1 = {
      R"(CREATE TABLE jobs (id TEXT PRIMARY KEY NOT NULL, request_id TEXT UNIQUE, request_digest BLOB NOT NULL,
           scene_name TEXT NOT NULL, threads INTEGER NOT NULL, state INTEGER NOT NULL, failure BLOB NOT NULL,
           attempt INTEGER NOT NULL, generation INTEGER NOT NULL, create_time_us INTEGER NOT NULL,
           start_time_us INTEGER NOT NULL, end_time_us INTEGER NOT NULL, fraction REAL NOT NULL, time REAL NOT NULL,
           step INTEGER NOT NULL, frame_count INTEGER NOT NULL, stored_bytes INTEGER NOT NULL) STRICT, WITHOUT ROWID;
         CREATE TABLE specs (job_id TEXT PRIMARY KEY NOT NULL REFERENCES jobs (id) ON DELETE CASCADE,
           spec BLOB NOT NULL) STRICT;)"};
  const std::string id = SampleJob(1).id;
  {
    Database old = OpenFormatted(directory_ / "control.db", 0x46534343, kFormat1);
    old.Execute(("INSERT INTO jobs VALUES ('" + id +
                 "', 'r', x'01', 'old', 3, 2, x'', 1, 1, 5, 6, 0, 0.5, 0.25, 8, 9, 10);"
                 "INSERT INTO specs VALUES ('" +
                 id + "', x'0203')")
                    .c_str());
  }
  {
    const std::unique_ptr<Store> store = Open();
    JobRecord job = *store->GetJob(id);
    EXPECT_EQ(job.scene_name, "old");
    EXPECT_EQ(job.spec, "\x02\x03");
    EXPECT_EQ(job.stored_bytes, 10);
    EXPECT_EQ(job.profile, "");
    job.profile = "where";
    store->UpdateJob(job);
  }
  EXPECT_EQ(Open()->GetJob(id)->profile, "where");
  EXPECT_EQ(Open()->ListJobs(1, "", {}).at(0).profile, "where");
}

// control.db in format 4, with a copy: its jobs have neither owners nor revisions, and get revisions.
TEST_F(SqliteStoreTest, JobsOfFormat4AreTakenOver) {
  constexpr int kJobs = 300;
  for (const char* file : {"control.db", "control.copy.db"}) {
    Database old = OpenFormatted(directory_ / file, kControlApplicationId, ControlFormats().first(4));
    for (int i = 0; i < kJobs; ++i) {
      old.Execute(("INSERT INTO jobs VALUES ('" + SampleJob(i).id +
                   "', NULL, x'01', 'old', 3, 5, x'', 1, 1, 5, 6, 7, 0.5, 0.25, 8, 9, 10, x'', x'', 0, -1, 0);"
                   "INSERT INTO specs VALUES ('" +
                   SampleJob(i).id + "', x'0203', 0)")
                      .c_str());
    }
    old.Execute(
        "UPDATE specs SET checksum = row_checksum(job_id, spec);"
        "UPDATE jobs SET checksum = row_checksum(id, request_id, request_digest, scene_name, threads, state, failure, "
        "attempt, generation, create_time_us, start_time_us, end_time_us, fraction, time, step, frame_count, "
        "stored_bytes, profile, warnings, crash_score, crash_place)");
    // A damage that was there before does not become the truth.
    const bool is_main = std::string_view(file) == "control.db";
    if (is_main) old.Execute(("UPDATE jobs SET scene_name = 'wrong' WHERE id = '" + SampleJob(7).id + "'").c_str());
  }
  std::int64_t revision = 0;
  {
    const std::unique_ptr<Store> store = Open();
    revision = store->Revision();
    EXPECT_GE(revision, kJobs);
    const JobChanges changes = store->ChangesAfter(0, revision, 1000).value();
    ASSERT_EQ(changes.changed.size(), std::size_t{kJobs});
    for (int i = 0; i < kJobs; ++i) EXPECT_EQ(changes.changed[static_cast<std::size_t>(i)].id, SampleJob(i).id);
    JobRecord job = *store->GetJob(SampleJob(5).id);
    EXPECT_EQ(job.spec, "\x02\x03");
    EXPECT_EQ(job.owner, "");
    EXPECT_EQ(store->GetJob(SampleJob(7).id)->scene_name, "old");
    job.labels = {{"a", "b"}};
    EXPECT_TRUE(store->UpdateSettings(job));
    JobQuery query = {.limit = 10};
    query.filter.groups = {{{.field = JobField::kLabel, .text = "b", .key = "a"}}};
    ASSERT_EQ(store->FindJobs(query).size(), 1u);
  }
  EXPECT_TRUE(fs::exists(directory_ / "control.db.damaged-1"));
  EXPECT_TRUE(fs::exists(directory_ / "control.db.format-4.backup"));
  EXPECT_EQ(Open()->Revision(), revision + 1);
}

// Revisions go on where they were, and deletions are remembered, over restarts.
TEST_F(SqliteStoreTest, ChangesAreToldAfterReopening) {
  std::int64_t before = 0;
  {
    const std::unique_ptr<Store> store = Open();
    for (int i = 1; i <= 2; ++i) store->CreateJob(SampleJob(i), &existing_);
    before = store->Revision();
    store->DeleteJob(SampleJob(2).id);
  }
  const std::unique_ptr<Store> store = Open();
  EXPECT_EQ(store->Revision(), before + 1);
  store->UpdateJob(SampleJob(1));
  const JobChanges changes = *store->ChangesAfter(before, 0, 10);
  ASSERT_EQ(changes.changed.size(), 1u);
  ASSERT_EQ(changes.deleted.size(), 1u);
  EXPECT_EQ(changes.deleted.front(), SampleJob(2).id);
}

// After a damage it is not known which jobs were deleted: who watched before must begin anew.
TEST_F(SqliteStoreTest, ADamagedControlDatabaseGivesNoRevisionTwice) {
  std::int64_t before = 0;
  {
    const std::unique_ptr<Store> store = Open();
    for (int i = 1; i <= 2; ++i) store->CreateJob(SampleJob(i), &existing_);
    store->DeleteJob(SampleJob(2).id);
    before = store->Revision();
  }
  fs::resize_file(directory_ / "control.db", 5000);
  const std::unique_ptr<Store> store = Open();
  EXPECT_TRUE(store->GetJob(SampleJob(1).id).has_value());
  EXPECT_GT(store->Revision(), before);
  EXPECT_FALSE(store->ChangesAfter(before, 0, 10).has_value());
  EXPECT_EQ(store->ChangesAfter(0, store->Revision(), 10)->changed.size(), 1u);
}

// Many threads change jobs while others read what has changed: nobody misses a change.
TEST_F(SqliteStoreTest, ReadersOfChangesMissNone) {
  constexpr int kWriters = 4, kJobs = 40;
  const std::unique_ptr<Store> store = Open();
  std::atomic<int> writers = kWriters;
  std::vector<std::thread> threads;
  for (int t = 0; t < kWriters; ++t) {
    threads.emplace_back([&, t] {
      for (int i = 0; i < kJobs; ++i) {
        JobRecord existing, job = SampleJob(t * kJobs + i);
        store->CreateJob(job, &existing);
        job.step = 1;
        store->UpdateJob(job);
        if (i % 3 == 0) store->DeleteJob(job.id);
      }
      --writers;
    });
  }
  std::map<std::string, std::int64_t> known;
  std::int64_t revision = 0;
  for (bool is_last = false; !is_last;) {
    is_last = writers == 0;
    while (true) {
      const JobChanges changes = *store->ChangesAfter(revision, 0, 7);
      for (const JobRecord& job : changes.changed) known[job.id] = job.step;
      for (const std::string& id : changes.deleted) known.erase(id);
      if (changes.revision == revision) break;
      revision = changes.revision;
    }
  }
  for (std::thread& thread : threads) thread.join();
  std::map<std::string, std::int64_t> expected;
  for (const JobRecord& job : store->ListJobs(1000, "", {})) expected[job.id] = job.step;
  EXPECT_EQ(known, expected);
  EXPECT_EQ(known.size(), std::size_t{kWriters * (kJobs - (kJobs + 2) / 3)});
}

TEST_F(SqliteStoreTest, DeletingAJobRemovesItsFile) {
  const std::unique_ptr<Store> store = Open();
  Fill(*store, 1, 2, 1000);
  Fill(*store, 2, 2, 1000);
  store->DeleteJob(SampleJob(1).id);
  EXPECT_FALSE(AreFilesOf(1));
  std::shared_ptr<FrameStore> used = store->OpenFrames(SampleJob(2).id);
  store->DeleteJob(SampleJob(2).id);
  EXPECT_TRUE(AreFilesOf(2));
  used.reset();
  EXPECT_FALSE(AreFilesOf(2));
}

TEST_F(SqliteStoreTest, RemovesOrphansAndFinishesFilesThatWereJustBegun) {
  {
    const std::unique_ptr<Store> store = Open();
    Fill(*store, 1, 1, 1000);
    store->CreateJob(SampleJob(2), &existing_);
  }
  for (const char* suffix : {".db", ".db-wal", ".db-shm"}) std::ofstream(directory_ / "jobs/orphan" + suffix) << "x";
  std::ofstream(FramesPath(2)).close();  // created, and then the process ended
  const std::unique_ptr<Store> store = Open();
  EXPECT_EQ(std::distance(fs::directory_iterator(directory_ / "jobs"), fs::directory_iterator()), 2);
  EXPECT_EQ(store->OpenFrames(SampleJob(1).id)->frame_count(), 1);
  EXPECT_EQ(store->OpenFrames(SampleJob(2).id)->frame_count(), 0);
}

TEST_F(SqliteStoreTest, ADamagedFileIsToldByNameAndTheOthersGoOn) {
  {
    const std::unique_ptr<Store> store = Open();
    for (int job : {1, 2, 3}) Fill(*store, job, 3, 100'000);
  }
  std::ofstream(FramesPath(1), std::ios::binary) << std::string(70'000, 'x');  // not a database any more
  fs::resize_file(FramesPath(2), 3 * 32768);                                   // truncated
  const std::unique_ptr<Store> store = Open();
  EXPECT_NE(ErrorOf([&] { store->OpenFrames(SampleJob(1).id); }).find(FramesPath(1)), std::string::npos);
  const std::string cut = ErrorOf([&] {
    const std::shared_ptr<FrameStore> frames = store->OpenFrames(SampleJob(2).id);
    for (int i = 0; i < 3; ++i) ReadFrame(*frames, i);
  });
  EXPECT_NE(cut.find(FramesPath(2)), std::string::npos) << cut;
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(ReadFrame(*store->OpenFrames(SampleJob(3).id), i), MakeSampleFrame(i, 100'000).bytes);
  }
  EXPECT_TRUE(store->DeleteJob(SampleJob(1).id));
  EXPECT_FALSE(AreFilesOf(1));
}

// While this exists no file may grow beyond `bytes`, which acts like a full disk.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit = {bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() { setrlimit(RLIMIT_FSIZE, &before_); }

 private:
  rlimit before_;
};

TEST_F(SqliteStoreTest, AFullDiskLosesNothingThatWasAcknowledged) {
  const std::unique_ptr<Store> store = Open();
  Fill(*store, 1, 2, 100'000);
  const std::shared_ptr<FrameStore> frames = store->OpenFrames(SampleJob(1).id);
  const SampleFrame large = MakeSampleFrame(2, 3'000'000);
  {
    const FileSizeLimit full(1'000'000);
    const std::string error = ErrorOf([&] { frames->PutFrame(large.record, large.bytes, "lost"); });
    EXPECT_NE(error.find(FramesPath(1)), std::string::npos) << error;
    JobRecord job = SampleJob(2);
    job.spec = SampleBytes(1, 3'000'000);
    EXPECT_NE(ErrorOf([&] { store->CreateJob(job, &existing_); }).find("control.db"), std::string::npos);
  }
  EXPECT_EQ(frames->frame_count(), 2);
  EXPECT_EQ(NewestCheckpoint(*frames), "checkpoint 1");
  EXPECT_FALSE(store->GetJob(SampleJob(2).id).has_value());
  // There is space again.
  EXPECT_FALSE(frames->PutFrame(large.record, large.bytes, "kept"));
  EXPECT_TRUE(store->CreateJob(SampleJob(2), &existing_));
  EXPECT_EQ(ReadFrame(*frames, 1), MakeSampleFrame(1, 100'000).bytes);
  EXPECT_EQ(ReadFrame(*frames, 2), large.bytes);
}

TEST_F(SqliteStoreTest, TheLogStaysSmall) {
  const std::unique_ptr<Store> store = Open();
  store->CreateJob(SampleJob(1), &existing_);
  const std::shared_ptr<FrameStore> frames = store->OpenFrames(SampleJob(1).id);
  const std::string bytes = SampleBytes(1, 4 << 20);
  std::uintmax_t largest = 0;
  for (int i = 0; i < 40; ++i) {
    frames->PutFrame(MakeSampleFrame(i, 10).record, bytes, "");
    frames->ReadChunk(i, 0);
    largest = std::max(largest, fs::file_size(FramesPath(1) + "-wal"));
  }
  EXPECT_LE(largest, std::uintmax_t{64} << 20);
}

TEST(GroupCommitTest, OneThatFailsLeavesTheOthers) {
  testing::TemporaryFolder directory;
  static constexpr std::array<const char*, 1> kFormats = {"CREATE TABLE numbers (n INTEGER PRIMARY KEY) STRICT"};
  Database database = OpenFormatted(directory / "numbers.db", 1, kFormats);
  Statement insert = database.Prepare("INSERT INTO numbers VALUES (?)");
  GroupCommit commit(database);
  constexpr int kThreads = 8, kEach = 30;
  std::atomic<int> failed = 0;
  std::vector<std::thread> threads;
  for (int t = 0; t < kThreads; ++t) {
    threads.emplace_back([&, t] {
      for (int i = 0; i < kEach; ++i) {
        const int number = i % 3 == 0 ? -1 : t * kEach + i;  // of all the -1 only one can be stored
        try {
          commit.Run([&] { insert.Run(number); });
        } catch (const StoreError&) {
          ++failed;
        }
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(failed, kThreads * kEach / 3 - 1);
  EXPECT_EQ(database.QueryInt("SELECT count(*) FROM numbers"), kThreads * kEach * 2 / 3 + 1);
}

}  // namespace
}  // namespace fascicle::server
