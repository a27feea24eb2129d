#include "core/base/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <stop_token>
#include <thread>
#include <vector>

namespace fascicle {
namespace {

TEST(ThreadTeamTest, CoversEveryIndexOnce) {
  for (const int threads : {1, 2, 3, 4, 8}) {
    ThreadTeam team(threads);
    EXPECT_EQ(team.size(), threads);
    for (const std::size_t count : {0u, 1u, 2u, 7u, 64u, 1000u, 4097u}) {
      for (const std::size_t grain : {0u, 1u, 10u, 5000u}) {
        std::vector<int> visits(count);
        team.For(count, grain, [&](std::size_t begin, std::size_t end) {
          EXPECT_LT(begin, end);
          EXPECT_LE(end, count);
          for (std::size_t i = begin; i < end; ++i) ++visits[i];
        });
        for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(visits[i], 1) << threads << " " << count << " " << grain;
      }
    }
  }
}

TEST(ThreadTeamTest, RangesAreAtLeastAGrainLong) {
  ThreadTeam team(4);
  std::atomic<int> short_ranges = 0;
  team.For(1005, 10, [&](std::size_t begin, std::size_t end) {
    if (end - begin < 10) ++short_ranges;
  });
  EXPECT_LE(short_ranges, 1);  // the last
}

// The terms differ so much in size that any other order of additions changes the sum.
TEST(ThreadTeamTest, SumsHaveTheSameBitsForAnyNumberOfThreads) {
  for (const std::size_t count : {0u, 1u, 1023u, 1024u, 1025u, 100000u}) {
    std::vector<double> values(count);
    for (std::size_t i = 0; i < count; ++i) values[i] = std::sin(double(i)) * std::pow(10.0, int(i % 17) - 8);
    const auto partial = [&](std::size_t begin, std::size_t end) {
      double sum = 0;
      for (std::size_t i = begin; i < end; ++i) sum += values[i];
      return sum;
    };
    ThreadTeam one(1);
    const double expected = one.Sum(count, partial);
    const double plain = std::accumulate(values.begin(), values.end(), 0.0);
    EXPECT_NEAR(expected, plain, 1e-12 * 1e8 * double(count + 1));
    for (const int threads : {2, 3, 4}) {
      ThreadTeam team(threads);
      for (int repeat = 0; repeat < 20; ++repeat) ASSERT_EQ(team.Sum(count, partial), expected) << threads;
    }
  }
}

TEST(ThreadTeamTest, ManyQuickLoops) {
  for (const int threads : {2, 4}) {
    ThreadTeam team(threads);
    std::vector<std::int64_t> values(64);
    for (int loop = 0; loop < 20000; ++loop) {
      team.For(values.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) values[i] += std::int64_t(i);
      });
    }
    for (std::size_t i = 0; i < values.size(); ++i) EXPECT_EQ(values[i], 20000 * std::int64_t(i));
  }
}

// Loops after a pause find the threads asleep and wake them up.
TEST(ThreadTeamTest, WakesSleepingThreads) {
  ThreadTeam team(4);
  for (int loop = 0; loop < 20; ++loop) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    std::atomic<int> visits = 0;
    team.For(100, 1, [&](std::size_t begin, std::size_t end) { visits += int(end - begin); });
    EXPECT_EQ(visits, 100);
  }
}

// Threads take part: in a loop of two parts, each waits for the other.
TEST(ThreadTeamTest, RunsPartsAtTheSameTime) {
  ThreadTeam team(2);
  std::atomic<int> inside = 0;
  team.For(2, 1, [&](std::size_t, std::size_t) {
    ++inside;
    while (inside < 2) std::this_thread::yield();
  });
  EXPECT_EQ(inside, 2);
}

// One part takes far longer than the others, so that the caller sleeps until it is done.
TEST(ThreadTeamTest, WaitsForTheSlowest) {
  ThreadTeam team(3);
  for (int loop = 0; loop < 5; ++loop) {
    std::vector<int> done(3);
    team.For(3, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds(i == 0 ? 1 : 10));
        done[i] = 1;
      }
    });
    EXPECT_EQ(done, std::vector<int>(3, 1));
  }
}

TEST(ThreadTeamTest, TeamsAreIndependent) {
  std::vector<std::thread> callers;
  std::vector<double> sums(3);
  for (int c = 0; c < 3; ++c) {
    callers.emplace_back([&, c] {
      ThreadTeam team(2);
      for (int loop = 0; loop < 200; ++loop) {
        sums[c] = team.Sum(5000, [](std::size_t begin, std::size_t end) { return double(end - begin); });
      }
    });
  }
  for (std::thread& caller : callers) caller.join();
  EXPECT_EQ(sums, std::vector<double>(3, 5000.0));
}

TEST(ThreadTeamDeathTest, NestedLoopsAreABug) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_DEATH(
      {
        ThreadTeam team(2);
        team.For(100, 1, [&](std::size_t, std::size_t) { team.For(100, 1, [](std::size_t, std::size_t) {}); });
      },
      "one loop at a time");
}

// After a stop request no further part of a loop begins, the caller gets Stopped, and the team can be used again.
TEST(ThreadTeamTest, StopsWithinALoop) {
  for (const int threads : {1, 2, 4}) {
    std::stop_source source;
    ThreadTeam team(threads, source.get_token());
    std::atomic<int> parts_begun = 0;
    EXPECT_THROW(team.For(10000, 1,
                          [&](std::size_t, std::size_t) {
                            ++parts_begun;
                            source.request_stop();
                          }),
                 Stopped);
    EXPECT_GE(parts_begun, 1);
    EXPECT_LE(parts_begun, threads) << "each thread was in one part at most";
    const int before = parts_begun;
    EXPECT_THROW(team.For(1, 1, [&](std::size_t, std::size_t) { ++parts_begun; }), Stopped);
    EXPECT_THROW(team.Sum(5000, [&](std::size_t, std::size_t) { return 1.0 * ++parts_begun; }), Stopped);
    EXPECT_THROW(team.ThrowIfStopped(), Stopped);
    EXPECT_EQ(parts_begun, before);
    team.HeedStop({});
    EXPECT_EQ(team.Sum(5000, [](std::size_t begin, std::size_t end) { return static_cast<double>(end - begin); }),
              5000);
  }
}

}  // namespace
}  // namespace fascicle
