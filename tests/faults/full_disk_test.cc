// A disk that is full for a while: jobs wait, new ones are refused, deleting works, and all goes on by itself.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mount.h>

#include <cstring>
#include <filesystem>
#include <fstream>

#include "server/jobs/job_manager.h"
#include "tests/support/box_jobs.h"
#include "tests/support/files.h"
#include "tests/support/store_samples.h"

namespace fascicle::server {
namespace {

using ::testing::HasSubstr;

class FullDiskTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (mount("tmpfs", disk_.path().c_str(), "tmpfs", 0, "size=40m") != 0) {
      GTEST_SKIP() << "a small disk can't be mounted here: " << std::strerror(errno);
    }
    mounted_ = true;
  }
  ~FullDiskTest() override {
    if (mounted_) umount(disk_.path().c_str());
  }

  std::unique_ptr<Store> Open() { return OpenSqliteStore(disk_ / "data"); }
  // Leaves at most `bytes` of the disk, while jobs write to it, too.
  void FillDisk(std::uintmax_t bytes) {
    std::ofstream file(disk_ / "filler", std::ios::binary);
    const std::string block(50'000, 'x');
    while (file && std::filesystem::space(disk_.path()).available > bytes) file << block << std::flush;
  }
  void EmptyDisk() { std::filesystem::remove(disk_ / "filler"); }

  testing::TemporaryFolder disk_;
  bool mounted_ = false;
};

TEST_F(FullDiskTest, JobsWaitAndGoOn) {
  const BoxSpec spec = {.duration = 3, .frame_interval = 0.02};
  const std::unique_ptr<Store> store = Open();
  JobManager manager(*store, BoxCodec(), Workers(1));
  const std::string done = manager.Submit(BoxJob({}), nullptr).record.id;
  ASSERT_EQ(WaitForEnd(manager, done).record.state, JobState::kSucceeded);
  const std::string running = manager.Submit(BoxJob(spec), nullptr).record.id;
  const std::string queued = manager.Submit(BoxJob({}), nullptr).record.id;
  ASSERT_TRUE(WaitForFrames(manager, running, 3));
  FillDisk(200'000);

  ASSERT_TRUE(Eventually([&] { return !manager.Get(running)->waiting.empty(); }));
  EXPECT_THAT(manager.Get(running)->waiting, HasSubstr("disk is almost full"));
  EXPECT_EQ(manager.Get(running)->record.state, JobState::kRunning);
  EXPECT_EQ(manager.Get(queued)->record.state, JobState::kQueued);
  EXPECT_THROW(manager.Submit(BoxJob({}), nullptr), NoSpaceError);
  EXPECT_THROW(store->BeginUpload(std::string(64, '0'), 10), NoSpaceError);
  EXPECT_EQ(StoredDigests(*manager.Frames(done)), DigestsByCore({})) << "what is stored can be read";
  EXPECT_EQ(manager.Delete(done), JobManager::DeleteResult::kDeleted);

  EmptyDisk();
  EXPECT_EQ(WaitForEnd(manager, running).record.state, JobState::kSucceeded);
  EXPECT_EQ(WaitForEnd(manager, queued).record.state, JobState::kSucceeded);
  EXPECT_EQ(StoredDigests(*manager.Frames(running)), DigestsByCore(spec));
  EXPECT_EQ(manager.Get(running)->waiting, "");
}

TEST_F(FullDiskTest, AWaitingJobCanBeCancelled) {
  const std::unique_ptr<Store> store = Open();
  JobManager manager(*store, BoxCodec(), Workers(1));
  const std::string id = manager.Submit(BoxJob(Longest()), nullptr).record.id;
  ASSERT_TRUE(WaitForFrames(manager, id, 3));
  FillDisk(200'000);
  ASSERT_TRUE(Eventually([&] { return !manager.Get(id)->waiting.empty(); }));
  manager.Cancel(id);
  EXPECT_EQ(WaitForEnd(manager, id).record.state, JobState::kCancelled);
}

TEST_F(FullDiskTest, TheServerStartsOnAFullDisk) {
  const BoxSpec spec = {.duration = 3, .frame_interval = 0.02};
  std::string id, done;
  {
    const std::unique_ptr<Store> store = Open();
    JobManager manager(*store, BoxCodec(), Workers(1));
    done = manager.Submit(BoxJob({}), nullptr).record.id;
    ASSERT_EQ(WaitForEnd(manager, done).record.state, JobState::kSucceeded);
    id = manager.Submit(BoxJob(spec), nullptr).record.id;
    ASSERT_TRUE(WaitForFrames(manager, id, 3));
    manager.Drain();
  }
  FillDisk(0);
  const std::unique_ptr<Store> store = Open();
  JobManager manager(*store, BoxCodec(), Workers(1));
  EXPECT_EQ(StoredDigests(*manager.Frames(done)), DigestsByCore({}));
  EXPECT_EQ(manager.Delete(done), JobManager::DeleteResult::kDeleted);
  EXPECT_FALSE(IsFinal(manager.Get(id)->record.state));
  EmptyDisk();
  EXPECT_EQ(WaitForEnd(manager, id).record.state, JobState::kSucceeded);
  EXPECT_EQ(StoredDigests(*manager.Frames(id)), DigestsByCore(spec));
}

}  // namespace
}  // namespace fascicle::server
