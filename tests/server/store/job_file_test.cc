// Jobs as files: what comes back is what was written, or an error.
#include "server/store/job_file.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <iostream>
#include <random>
#include <string>
#include <vector>

#include "core/base/stop.h"
#include "server/store/database.h"
#include "tests/support/files.h"
#include "tests/support/store_samples.h"

namespace fascicle::server {
namespace {

using testing::ReadFile;
using testing::TemporaryFolder;
using testing::WriteFile;

constexpr int kFramesInFile = 4;
const std::string kJobBytes = SampleBytes(5, 3000);
const std::string kGeometryBytes = SampleBytes(6, 1'200'000);  // two chunks

const SampleFrame& FrameOf(std::int64_t index) {
  static const std::vector<SampleFrame> frames = [] {
    std::vector<SampleFrame> made;
    for (std::int64_t i = 0; i < kFramesInFile; ++i) {
      made.push_back(MakeSampleFrame(i, i == 2 ? 1'100'000 : static_cast<std::size_t>(5000 * i + 1)));
    }
    return made;
  }();
  return frames[static_cast<std::size_t>(index)];
}

void WriteSample(const std::string& path) {
  const std::unique_ptr<Store> store = MakeMemoryStore();
  JobRecord existing;
  store->CreateJob(SampleJob(1), &existing);
  const std::shared_ptr<FrameStore> frames = store->OpenFrames(SampleJob(1).id);
  frames->PutGeometry(kGeometryBytes);
  for (std::int64_t i = 0; i < kFramesInFile; ++i) frames->PutFrame(FrameOf(i).record, FrameOf(i).bytes, "");
  WriteJobFile(path, kJobBytes, *frames, frames->frame_count(), [] { return true; });
}

// Whether the file has what was written; throws JobFileError.
bool IsSample(const std::string& path) {
  JobFileReader reader(path);
  bool same =
      reader.ReadJob() == kJobBytes && reader.ReadGeometry() == kGeometryBytes && reader.frame_count() == kFramesInFile;
  for (std::int64_t i = 0; same && i < kFramesInFile; ++i) {
    const JobFileReader::StoredFrame frame = reader.ReadNextFrame();
    same = frame.record == FrameOf(i).record && frame.bytes == FrameOf(i).bytes;
  }
  return same;
}

// The message of the error that reading ends with.
std::string ReadingError(const std::string& path) {
  try {
    return IsSample(path) ? "none" : "wrong bytes";
  } catch (const JobFileError& error) {
    return error.what();
  }
}

class JobFileTest : public ::testing::Test {
 protected:
  void SetUp() override { WriteSample(path_); }
  // Changes the file by SQL, as anyone can.
  void Change(const char* sql) { Database(path_, Database::Mode::kReadWrite).Execute(sql); }

  TemporaryFolder folder_;
  const std::string path_ = folder_ / "job.fascicle";
};

TEST_F(JobFileTest, WhatIsWrittenComesBack) { EXPECT_EQ(ReadingError(path_), "none"); }

TEST_F(JobFileTest, WritingStopsOnRequest) {
  const std::unique_ptr<Store> store = MakeMemoryStore();
  JobRecord existing;
  store->CreateJob(SampleJob(1), &existing);
  const std::shared_ptr<FrameStore> frames = store->OpenFrames(SampleJob(1).id);
  frames->PutFrame(FrameOf(0).record, FrameOf(0).bytes, "");
  EXPECT_THROW(WriteJobFile(folder_ / "other", kJobBytes, *frames, 1, [] { return false; }), Stopped);
}

// 300 single flips, or FASCICLE_BIT_FLIPS.
TEST_F(JobFileTest, AFlippedBitGivesAnErrorOrTheSameBytes) {
  const char* number = std::getenv("FASCICLE_BIT_FLIPS");
  const int flips = number != nullptr ? std::atoi(number) : 300;
  const std::string good = ReadFile(path_);
  std::mt19937_64 random(1818);
  int refused = 0;
  for (int i = 0; i < flips; ++i) {
    std::string bad = good;
    // Every other one in the first pages, which have the header, the schema and small rows.
    const std::size_t at = random() % (i % 2 == 0 ? std::size_t{60'000} : bad.size());
    const int bit = static_cast<int>(random() % 8);
    bad[at] ^= static_cast<char>(1 << bit);
    WriteFile(path_, bad);
    const std::string error = ReadingError(path_);
    EXPECT_NE(error, "wrong bytes") << "bit " << bit << " of byte " << at;
    refused += error != "none";
  }
  std::cout << flips << " flips: " << refused << " refused, the others changed nothing that is read\n";
  EXPECT_GT(refused, flips / 2);
}

TEST_F(JobFileTest, EveryTruncationIsRefused) {
  const std::string good = ReadFile(path_);
  for (const std::size_t size : {std::size_t{0}, std::size_t{50}, std::size_t{100}, std::size_t{8192},
                                 std::size_t{60'000}, good.size() / 2, good.size() - 8192, good.size() - 1}) {
    WriteFile(path_, good.substr(0, size));
    EXPECT_NE(ReadingError(path_), "wrong bytes") << size;
    if (size + 1 < good.size()) {
      EXPECT_NE(ReadingError(path_), "none") << size;
    }
  }
}

TEST_F(JobFileTest, OtherFilesAreRefusedInPlainWords) {
  WriteFile(path_,
            "a letter, not a job, and long enough for a header of a hundred bytes, which this one is by now.....");
  EXPECT_NE(ReadingError(path_).find("not a job that was exported"), std::string::npos);
  WriteSample(folder_ / "second");
  Database(folder_ / "second", Database::Mode::kReadWrite).Execute("PRAGMA user_version = 7");
  EXPECT_NE(ReadingError(folder_ / "second").find("format 7"), std::string::npos);
  Database(folder_ / "second", Database::Mode::kReadWrite).Execute("PRAGMA application_id = 5");
  EXPECT_NE(ReadingError(folder_ / "second").find("another kind"), std::string::npos);
  // As a server keeps it: with a write-ahead log.
  Database(folder_ / "second", Database::Mode::kReadWrite).Execute("PRAGMA journal_mode = WAL");
  EXPECT_NE(ReadingError(folder_ / "second").find("another kind"), std::string::npos);
}

TEST_F(JobFileTest, MoreThanAJobIsRefused) {
  for (const char* sql :
       {"CREATE VIEW more AS SELECT 1", "CREATE TABLE more (x)", "CREATE INDEX more ON frames (time)",
        "CREATE TRIGGER more AFTER INSERT ON frames BEGIN SELECT 1; END", "ALTER TABLE frames ADD COLUMN more INTEGER",
        "DROP TABLE geometry; CREATE VIEW geometry AS SELECT 0 AS chunk, x'00' AS bytes, 0 AS checksum",
        "DROP TABLE geometry; CREATE TABLE geometry (chunk INTEGER PRIMARY KEY, bytes BLOB AS (zeroblob(1000000000)), "
        "checksum INTEGER)"}) {
    WriteFile(path_, "");
    std::filesystem::remove(path_);
    WriteSample(path_);
    Change(sql);
    EXPECT_NE(ReadingError(path_).find("job that was exported"), std::string::npos)
        << sql << ": " << ReadingError(path_);
  }
}

TEST_F(JobFileTest, RowsWithoutTheirChecksumAreRefused) {
  for (const char* sql :
       {"UPDATE frames SET time = 7 WHERE idx = 1", "UPDATE chunks SET frame = 3 WHERE number = 1",
        "UPDATE chunks SET bytes = zeroblob(length(bytes))", "DELETE FROM frames WHERE idx = 3",
        "DELETE FROM chunks WHERE number = 2", "DELETE FROM contents", "UPDATE contents SET frames = 3",
        "UPDATE contents SET frames = -1, checksum = row_checksum(0, 1, 2, -1)", "DELETE FROM job",
        "UPDATE geometry SET chunk = 5 WHERE chunk = 1"}) {
    std::filesystem::remove(path_);
    WriteSample(path_);
    Change(sql);
    EXPECT_NE(ReadingError(path_).find("damaged"), std::string::npos) << sql << ": " << ReadingError(path_);
  }
}

// Rows with valid checksums, made by hand to be expensive.
TEST_F(JobFileTest, ExpensiveRowsAreRefused) {
  Change(
      "UPDATE frames SET size = 400000000000, checksum = row_checksum(idx, time, step, 400000000000, digest) WHERE "
      "idx = 0");
  EXPECT_NE(ReadingError(path_), "none");
  std::filesystem::remove(path_);
  WriteSample(path_);
  Change(
      "UPDATE chunks SET bytes = zeroblob(30000000), checksum = row_checksum(number, frame, chunk, zeroblob(30000000)) "
      "WHERE number = 0");
  EXPECT_NE(ReadingError(path_), "none");
  // Thousands of tables.
  std::filesystem::remove(path_);
  WriteSample(path_);
  std::string tables = "BEGIN;";
  for (int i = 0; i < 5000; ++i) tables += "CREATE TABLE t" + std::to_string(i) + " (x);";
  Change((tables + "COMMIT").c_str());
  EXPECT_NE(ReadingError(path_), "none");
}

}  // namespace
}  // namespace fascicle::server
