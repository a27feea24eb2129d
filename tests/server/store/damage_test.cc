// Damaged files: what is damaged is told, the rest is served, and what can be repaired is.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <memory>

#include "server/store/database.h"
#include "server/store/store.h"
#include "tests/support/files.h"
#include "tests/support/store_samples.h"

namespace fascicle::server {
namespace {

namespace fs = std::filesystem;

class DamageTest : public ::testing::Test {
 protected:
  std::unique_ptr<Store> Open() { return OpenSqliteStore(directory_.path()); }
  std::string FramesPath() { return directory_ / "jobs/" + SampleJob(1).id + ".db"; }
  // A job with three frames, each with a checkpoint.
  std::unique_ptr<Store> Fill() {
    std::unique_ptr<Store> store = Open();
    JobRecord existing;
    store->CreateJob(SampleJob(1), &existing);
    store->CreateJob(SampleJob(2), &existing);
    const std::shared_ptr<FrameStore> frames = store->OpenFrames(SampleJob(1).id);
    frames->PutGeometry("geometry");
    for (int i = 0; i < 3; ++i) {
      const SampleFrame frame = MakeSampleFrame(i, 1'200'000);
      frames->PutFrame(frame.record, frame.bytes, "checkpoint " + std::to_string(i));
    }
    return store;
  }
  void Change(const std::string& path, const char* sql) { Database(path, Database::Mode::kReadWrite).Execute(sql); }
  void Overwrite(const std::string& path) { std::ofstream(path, std::ios::binary) << std::string(60'000, 'x'); }

  testing::TemporaryFolder directory_;
};

TEST_F(DamageTest, ADamagedFrameIsToldAndWrittenAnew) {
  const std::unique_ptr<Store> store = Fill();
  Change(FramesPath(), "UPDATE chunks SET bytes = x'00' WHERE frame = 1 AND chunk = 1");
  const std::shared_ptr<FrameStore> frames = store->OpenFrames(SampleJob(1).id);
  EXPECT_THROW(frames->ReadChunk(1, 1), DamageError);
  EXPECT_EQ(ReadFrame(*frames, 2), MakeSampleFrame(2, 1'200'000).bytes);
  // A restart computes the frame again.
  const SampleFrame frame = MakeSampleFrame(1, 1'200'000);
  EXPECT_FALSE(frames->PutFrame(frame.record, frame.bytes, "")) << "it is not another frame";
  EXPECT_EQ(ReadFrame(*frames, 1), frame.bytes);
  EXPECT_EQ(frames->frame_count(), 3);
  EXPECT_EQ(frames->stored_bytes(), 3 * 1'200'000 + 8);
}

// Without its inputs, a restart would compute other frames and not say so.
TEST_F(DamageTest, FramesAreKeptWhileAnInputCannotBeRead) {
  const std::unique_ptr<Store> store = Fill();
  store->OpenFrames(SampleJob(1).id)->PutSteering({1, 7, {}, 0, "an input"});
  Change(FramesPath(), "UPDATE steering SET input = x'00'");
  JobRecord job = SampleJob(1);
  job.first_frame = job.frame_count = 3;
  EXPECT_THROW(store->RemoveFrames(job), DamageError);
  EXPECT_EQ(store->GetJob(job.id)->first_frame, 0);
  EXPECT_EQ(store->OpenFrames(job.id)->frame_count(), 3);
}

TEST_F(DamageTest, AChunkInThePlaceOfAnotherIsTold) {
  const std::unique_ptr<Store> store = Fill();
  Change(FramesPath(), "DELETE FROM chunks WHERE frame = 2 AND chunk = 0");
  Change(FramesPath(), "UPDATE chunks SET frame = 2 WHERE frame = 1 AND chunk = 0");
  EXPECT_THROW(store->OpenFrames(SampleJob(1).id)->ReadChunk(2, 0), DamageError);
}

TEST_F(DamageTest, ADamagedRecordOfAFrameIsToldAndWrittenAnew) {
  const std::unique_ptr<Store> store = Fill();
  Change(FramesPath(), "UPDATE frames SET time = 7 WHERE idx = 1");
  const std::shared_ptr<FrameStore> frames = store->OpenFrames(SampleJob(1).id);
  EXPECT_THROW(frames->ListFrames(1, 1), DamageError);
  EXPECT_EQ(frames->ListFrames(2, 1).size(), 1u);
  const SampleFrame frame = MakeSampleFrame(1, 1'200'000);
  frames->PutFrame(frame.record, frame.bytes, "");
  EXPECT_TRUE(frames->ListFrames(1, 1).front() == frame.record);
}

TEST_F(DamageTest, BehindADamagedCheckpointIsTheOneBefore) {
  const std::unique_ptr<Store> store = Fill();
  Change(FramesPath(), "UPDATE checkpoints SET bytes = x'00' WHERE frame = 2");
  EXPECT_EQ(NewestCheckpoint(*store->OpenFrames(SampleJob(1).id)), "checkpoint 1");
}

TEST_F(DamageTest, ADamagedGeometryIsToldAndReplaced) {
  const std::unique_ptr<Store> store = Fill();
  Change(FramesPath(), "UPDATE geometry SET bytes = x'67'");
  const std::shared_ptr<FrameStore> frames = store->OpenFrames(SampleJob(1).id);
  EXPECT_THROW(frames->ReadGeometryChunk(0), DamageError);
  frames->PutGeometry("geometry");
  EXPECT_EQ(ReadGeometry(*frames), "geometry");
}

TEST_F(DamageTest, ADamagedRecordOfAJobIsReadFromTheCopy) {
  const std::unique_ptr<Store> store = Fill();
  Change(directory_ / "control.db", "UPDATE jobs SET threads = 9; UPDATE specs SET spec = x'00'");
  EXPECT_EQ(store->GetJob(SampleJob(1).id)->threads, SampleJob(1).threads);
  EXPECT_EQ(store->GetJob(SampleJob(1).id)->spec, SampleJob(1).spec);
  EXPECT_EQ(store->ListJobs(10, "", {}).size(), 2u);
  // Its checksum is not renewed by a later change.
  EXPECT_THROW(store->UpdateJob(SampleJob(1)), DamageError);
}

TEST_F(DamageTest, ADamagedControlDatabaseIsMadeAgainFromItsCopy) {
  Fill();
  Overwrite(directory_ / "control.db");
  const std::unique_ptr<Store> store = Open();
  EXPECT_EQ(store->ListJobs(10, "", {}).size(), 2u);
  EXPECT_EQ(store->GetJob(SampleJob(1).id)->spec, SampleJob(1).spec);
  EXPECT_EQ(store->OpenFrames(SampleJob(1).id)->frame_count(), 3);
  EXPECT_TRUE(fs::exists(directory_ / "control.db.damaged-1"));
  JobRecord job = SampleJob(1);
  job.state = JobState::kFailed;
  store->UpdateJob(job);
  EXPECT_EQ(store->GetJob(SampleJob(1).id)->state, JobState::kFailed);
}

TEST_F(DamageTest, ADamagedCopyIsMadeAgain) {
  Fill();
  Overwrite(directory_ / "control.copy.db");
  { EXPECT_EQ(Open()->ListJobs(10, "", {}).size(), 2u); }
  Overwrite(directory_ / "control.db");
  EXPECT_EQ(Open()->ListJobs(10, "", {}).size(), 2u);
}

TEST_F(DamageTest, FramesOfLostJobsAreKept) {
  Fill();
  Overwrite(directory_ / "control.db");
  Overwrite(directory_ / "control.copy.db");
  EXPECT_NE(ErrorOf([&] { Open(); }), "") << "nothing can be read: this is for a person to decide";
  EXPECT_TRUE(fs::exists(FramesPath()));
}

TEST_F(DamageTest, ADamagedAssetIsToldAndCanBeUploadedAgain) {
  const std::string digest = "2cf24dba5fb0a30e26e83b2ac5b9e29e1b161e5c1fa7425e73043362938b9824";  // of "hello"
  const std::unique_ptr<Store> store = Open();
  const auto upload = [&] {
    const auto open = store->BeginUpload(digest, 5);
    open->Write("hello");
    return open->Commit();
  };
  ASSERT_TRUE(upload());
  std::ofstream(directory_ / "assets/2c/" + digest) << "hellp";
  EXPECT_THROW(store->ReadAsset(digest), DamageError);
  EXPECT_FALSE(store->HasAsset(digest));
  EXPECT_TRUE(upload());
  EXPECT_EQ(store->ReadAsset(digest), "hello");
}

}  // namespace
}  // namespace fascicle::server
