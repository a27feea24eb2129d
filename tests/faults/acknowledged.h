#ifndef FASCICLE_TESTS_FAULTS_ACKNOWLEDGED_H_
#define FASCICLE_TESTS_FAULTS_ACKNOWLEDGED_H_

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "crash_samples.h"
#include "server/store/database.h"
#include "server/store/store.h"
#include "tests/support/store_samples.h"

namespace fascicle::server {

// What a writer (store_crash_writer.cc) has reported.
struct Acknowledged {
  std::set<int> jobs;
  std::map<int, std::int64_t> frames;  // number of a job -> count

  void Read(const std::string& report) {
    std::istringstream lines(report);
    char kind = 0;
    int number = 0;
    while (lines >> kind >> number) {
      if (kind == 'J') {
        jobs.insert(number);
      } else {
        std::int64_t index = -1;
        lines >> index;
        frames[number] = index + 1;
      }
    }
  }
};

inline void ExpectWhole(const std::string& path) {
  Database database(path, Database::Mode::kReadOnly);
  Statement check = database.Prepare("PRAGMA integrity_check");
  Rows rows = check.Query();
  ASSERT_TRUE(rows.Next());
  EXPECT_EQ(rows.String(0), "ok") << path;
}

inline void ExpectFrames(Store& store, int number, std::int64_t acknowledged) {
  const std::shared_ptr<FrameStore> frames = store.OpenFrames(SampleJob(number).id);
  ASSERT_NE(frames, nullptr);
  const std::int64_t count = frames->frame_count();
  // One more may have been committed without being reported.
  EXPECT_GE(count, acknowledged);
  EXPECT_LE(count, acknowledged + 1);
  const std::vector<FrameRecord> records = frames->ListFrames(0, 1 << 20);
  ASSERT_EQ(static_cast<std::int64_t>(records.size()), count);
  for (std::int64_t i = 0; i < count; ++i) {
    const SampleFrame expected = CrashFrame(number, i);
    EXPECT_TRUE(records[static_cast<std::size_t>(i)] == expected.record) << i;
    EXPECT_TRUE(ReadFrame(*frames, i) == expected.bytes) << i;
  }
  if (count == 0) return;
  EXPECT_EQ(NewestCheckpoint(*frames), CrashCheckpoint(number, (count - 1) / 3 * 3));
}

// Everything that was acknowledged is there.
inline void ExpectAll(Store& store, const Acknowledged& acknowledged) {
  for (const int number : acknowledged.jobs) {
    const std::optional<JobRecord> job = store.GetJob(SampleJob(number).id);
    ASSERT_TRUE(job.has_value()) << "job " << number;
    EXPECT_EQ(job->spec, SampleJob(number).spec);
  }
  for (const auto& [number, count] : acknowledged.frames) ExpectFrames(store, number, count);
}

}  // namespace fascicle::server

#endif  // FASCICLE_TESTS_FAULTS_ACKNOWLEDGED_H_
