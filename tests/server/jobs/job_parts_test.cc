// Identifiers and the estimated time to the end.
#include <gtest/gtest.h>

#include <algorithm>
#include <mutex>
#include <set>
#include <thread>

#include "server/jobs/eta.h"
#include "server/jobs/job_id.h"

namespace fascicle::server {
namespace {

TEST(JobIdGeneratorTest, MakesIdsThatSortByCreation) {
  JobIdGenerator generator("");
  std::string last;
  for (std::int64_t time : {1'700'000'000'000, 1'700'000'000'000, 1'700'000'000'001, 1'700'000'000'000,
                            1'600'000'000'000, 1'800'000'000'000}) {
    for (int i = 0; i < 100; ++i) {
      const std::string id = generator.Next(time);
      EXPECT_EQ(id.size(), 26u);
      EXPECT_EQ(id.find_first_not_of("0123456789abcdefghjkmnpqrstvwxyz"), std::string::npos);
      EXPECT_GT(id, last);
      last = id;
    }
  }
}

TEST(JobIdGeneratorTest, StartsWithTheTime) {
  JobIdGenerator generator("");
  // 1,469,918,176,385 ms is 01aryz6s41 in Crockford's base 32: the example of the ULID specification.
  EXPECT_EQ(generator.Next(1'469'918'176'385).substr(0, 10), "01aryz6s41");
}

TEST(JobIdGeneratorTest, GoesOnAfterTheNewestId) {
  const std::string newest = JobIdGenerator("").Next(1'900'000'000'000);
  EXPECT_GT(JobIdGenerator(newest).Next(1'700'000'000'000), newest);
  EXPECT_EQ(JobIdGenerator("7zzzzzzzzzzzzzzzzzzzzzzzzy").Next(1), "7zzzzzzzzzzzzzzzzzzzzzzzzz");
  EXPECT_EQ(JobIdGenerator("0123456789zzzzzzzzzzzzzzzz").Next(1), "012345678a0000000000000000");
}

TEST(JobIdGeneratorTest, DiffersBetweenProcessesAndThreads) {
  EXPECT_NE(JobIdGenerator("").Next(1'700'000'000'000), JobIdGenerator("").Next(1'700'000'000'000));
  JobIdGenerator generator("");
  std::mutex mutex;
  std::set<std::string> ids;
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&] {
      for (int i = 0; i < 500; ++i) {
        const std::string id = generator.Next(1'700'000'000'000);
        const std::lock_guard lock(mutex);
        ids.insert(id);
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(ids.size(), 2000u);
}

class EtaTest : public ::testing::Test {
 protected:
  // Adds samples every millisecond for `seconds`, at `speed` [1/s].
  void Run(double seconds, double speed) {
    for (int i = 0; i < static_cast<int>(seconds * 1000); ++i) {
      now_ += std::chrono::milliseconds(1);
      fraction_ += speed / 1000;
      eta_.Add(fraction_, now_);
    }
  }

  EtaEstimator eta_;
  EtaEstimator::TimePoint now_{std::chrono::hours(1)};
  double fraction_ = 0;
};

TEST_F(EtaTest, IsUnknownAtFirst) {
  EXPECT_LT(eta_.Seconds(now_), 0);
  Run(0.1, 0.1);
  EXPECT_LT(eta_.Seconds(now_), 0);
}

TEST_F(EtaTest, IsExactAtConstantSpeed) {
  Run(3, 0.01);
  EXPECT_NEAR(eta_.Seconds(now_), 97, 0.5);
  EXPECT_NEAR(eta_.Seconds(now_ + std::chrono::seconds(7)), 90, 0.5);
  EXPECT_EQ(eta_.Seconds(now_ + std::chrono::hours(1)), 0);
}

TEST_F(EtaTest, FollowsAChangeOfSpeedSmoothly) {
  Run(5, 0.02);
  const double before = eta_.Seconds(now_);
  Run(0.3, 0.002);
  EXPECT_NEAR(eta_.Seconds(now_), before, 0.1 * before);
  Run(40, 0.002);
  EXPECT_NEAR(eta_.Seconds(now_), (1 - fraction_) / 0.002, 0.2 * (1 - fraction_) / 0.002);
}

TEST_F(EtaTest, StartsFromWhereAJobGoesOn) {
  fraction_ = 0.9;
  Run(2, 0.01);
  EXPECT_NEAR(eta_.Seconds(now_), 8, 0.5);
}

}  // namespace
}  // namespace fascicle::server
