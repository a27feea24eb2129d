// A data folder with one flipped bit anywhere: what is delivered is what was stored, and everything else is served.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "core/base/digest.h"
#include "server/store/store.h"
#include "tests/support/files.h"
#include "tests/support/store_samples.h"

namespace fascicle::server {
namespace {

namespace fs = std::filesystem;

constexpr int kJobs = 5, kFrames = 4;

std::size_t FrameSize(int job, std::int64_t frame) { return job == 0 && frame == 1 ? 1'300'000 : 200 + 9'000 * frame; }
std::string GeometryOf(int job) { return SampleBytes(static_cast<std::uint64_t>(job) + 77, 20'000); }
std::string CheckpointOf(std::int64_t frame) { return SampleBytes(static_cast<std::uint64_t>(frame) + 5, 5'000); }
std::string Asset(int number) { return SampleBytes(static_cast<std::uint64_t>(number) + 1000, 30'000); }

JobRecord JobOf(int number) {
  JobRecord job = SampleJob(number);
  job.request_id = "request " + std::to_string(number);
  if (number == 1) job.spec = SampleBytes(3, 150'000);
  return job;
}

// The folder as it should be.
void Fill(const std::string& directory) {
  const std::unique_ptr<Store> store = OpenSqliteStore(directory);
  JobRecord existing;
  for (int number = 0; number < kJobs; ++number) {
    JobRecord job = JobOf(number);
    store->CreateJob(job, &existing);
    const std::shared_ptr<FrameStore> frames = store->OpenFrames(job.id);
    frames->PutGeometry(GeometryOf(number));
    for (std::int64_t f = 0; f < kFrames; ++f) {
      const SampleFrame frame = MakeSampleFrame(f, FrameSize(number, f), static_cast<std::uint64_t>(number));
      frames->PutFrame(frame.record, frame.bytes, f % 2 == 1 ? CheckpointOf(f) : "");
    }
    job.state = JobState::kSucceeded;
    job.frame_count = kFrames;
    store->UpdateJob(job);
  }
  for (int i = 0; i < 2; ++i) {
    const std::string bytes = Asset(i);
    const auto upload = store->BeginUpload(Hex(Sha256Of(bytes)), static_cast<std::int64_t>(bytes.size()));
    upload->Write(bytes);
    upload->Commit();
  }
}

// What one reading of the whole folder found.
struct Found {
  int wrong = 0;  // different from what was stored, without an error
  int told = 0;   // errors
  int served = 0;
};

// Counts the answer of `read` as right, wrong, or told to be damaged.
template <class Read>
void Look(Found& found, const Read& read) {
  try {
    ++(read() ? found.served : found.wrong);
  } catch (const StoreError&) {
    ++found.told;
  }
}

bool SameRecord(const JobRecord& a, const JobRecord& b) {
  return a.id == b.id && a.request_id == b.request_id && a.request_digest == b.request_digest &&
         a.scene_name == b.scene_name && a.threads == b.threads && a.state == JobState::kSucceeded &&
         a.create_time_us == b.create_time_us && a.frame_count == kFrames;
}

void ReadFrames(Store& store, int number, Found& found) {
  std::shared_ptr<FrameStore> frames;
  Look(found, [&] { return (frames = store.OpenFrames(JobOf(number).id)) != nullptr; });
  if (frames == nullptr) return;
  Look(found, [&] { return ReadGeometry(*frames) == GeometryOf(number); });
  for (std::int64_t f = 0; f < kFrames; ++f) {
    const SampleFrame expected = MakeSampleFrame(f, FrameSize(number, f), static_cast<std::uint64_t>(number));
    // As the service reads: records first, then the chunks that the record announces.
    Look(found, [&] {
      const std::vector<FrameRecord> records = frames->ListFrames(f, 1);
      if (records.empty() || records[0].index != f) throw DamageError("the frame is missing");
      if (!(records[0] == expected.record)) return false;
      const std::string bytes = ReadFrame(*frames, f);
      if (static_cast<std::int64_t>(bytes.size()) != records[0].size) throw DamageError("a chunk is missing");
      return bytes == expected.bytes;
    });
  }
  Look(found, [&] {
    const auto checkpoint = frames->GetCheckpoint(kFrames);
    return !checkpoint || checkpoint->bytes == CheckpointOf(checkpoint->frame);
  });
}

Found ReadAll(const std::string& directory) {
  Found found;
  std::unique_ptr<Store> store;
  Look(found, [&] { return (store = OpenSqliteStore(directory)) != nullptr; });
  if (store == nullptr) return found;
  for (int number = 0; number < kJobs; ++number) {
    const JobRecord expected = JobOf(number);
    Look(found, [&] {
      const std::optional<JobRecord> job = store->GetJob(expected.id);
      return job && SameRecord(*job, expected) && job->spec == expected.spec;
    });
    ReadFrames(*store, number, found);
  }
  Look(found, [&] { return store->ListJobs(100, "", {}).size() == kJobs; });
  for (int i = 0; i < 2; ++i) {
    Look(found, [&] {
      const std::optional<std::string> bytes = store->ReadAsset(Hex(Sha256Of(Asset(i))));
      return bytes && *bytes == Asset(i);
    });
  }
  return found;
}

std::vector<fs::path> FilesIn(const std::string& directory) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(directory)) {
    if (entry.is_regular_file() && entry.file_size() > 0 && entry.path().filename() != "reserve") {
      files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

// Returns what was done, for messages.
std::string FlipOne(const std::string& directory, std::mt19937_64& random) {
  const std::vector<fs::path> files = FilesIn(directory);
  const fs::path& path = files[random() % files.size()];
  const std::uintmax_t at = random() % fs::file_size(path);
  const int bit = static_cast<int>(random() % 8);
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  char byte = 0;
  file.seekg(static_cast<std::streamoff>(at)).get(byte);
  file.seekp(static_cast<std::streamoff>(at)).put(static_cast<char>(byte ^ (1 << bit)));
  return "bit " + std::to_string(bit) + " of byte " + std::to_string(at) + " of " + path.filename().string();
}

int Flips() {
  const char* number = std::getenv("FASCICLE_BIT_FLIPS");
  return number != nullptr ? std::atoi(number) : 300;
}

TEST(BitFlipTest, NothingWrongIsDelivered) {
  testing::TemporaryFolder intact, damaged;
  Fill(intact.path());
  const Found all = ReadAll(intact.path());
  ASSERT_EQ(all.wrong + all.told, 0);
  std::mt19937_64 random(2611);
  Found sum;
  int noticed = 0;
  for (int flip = 0; flip < Flips(); ++flip) {
    fs::remove_all(damaged.path());
    fs::copy(intact.path(), damaged.path(), fs::copy_options::recursive);
    const std::string where = FlipOne(damaged.path(), random);
    const Found found = ReadAll(damaged.path());
    EXPECT_EQ(found.wrong, 0) << where;
    // One flip damages one file: at most all of one job.
    EXPECT_GE(found.served, all.served - (kFrames + 3)) << where;
    sum.wrong += found.wrong;
    sum.told += found.told;
    noticed += found.told > 0;
  }
  std::cout << Flips() << " flips: " << noticed << " noticed (" << sum.told << " errors), " << sum.wrong
            << " wrong answers\n";
  EXPECT_GT(noticed, Flips() / 20) << "the test does not reach what is read";
}

}  // namespace
}  // namespace fascicle::server
