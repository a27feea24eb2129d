#include "core/base/stop.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <numeric>
#include <vector>

#include "core/base/parallel.h"

namespace fascicle {
namespace {

TEST(Stop, ThrowsAfterTheRequestOnly) {
  std::stop_source source;
  ThrowIfStopped(source.get_token());
  ThrowIfStopped({});
  source.request_stop();
  EXPECT_THROW(ThrowIfStopped(source.get_token()), Stopped);
}

std::vector<int> Mixed(int count) {
  std::vector<int> items(count);
  for (int i = 0; i < count; ++i) items[i] = i * 7919 % count;
  return items;
}

TEST(Stop, SortsAsStdSortDoes) {
  std::vector<int> items = Mixed(1000), expected = items;
  SortUnlessStopped(items, {});
  std::sort(expected.begin(), expected.end());
  EXPECT_EQ(items, expected);
  SortUnlessStopped(items, {}, std::greater<>());
  std::reverse(expected.begin(), expected.end());
  EXPECT_EQ(items, expected);
}

TEST(Stop, EndsASortInTheMiddle) {
  std::stop_source source;
  std::vector<int> items = Mixed(1000);
  int comparisons = 0;
  const auto less = [&](int a, int b) {
    if (++comparisons == 50) source.request_stop();
    return a < b;
  };
  EXPECT_THROW(SortUnlessStopped(items, source.get_token(), less), Stopped);
  EXPECT_EQ(comparisons, 50);
}

TEST(Stop, ForEachCoversEveryIndexOnce) {
  for (const int threads : {1, 3}) {
    ThreadTeam team(threads);
    std::vector<int> visits(1000);
    ForEach(team, visits.size(), 10, [&](std::size_t i) { ++visits[i]; });
    EXPECT_EQ(std::count(visits.begin(), visits.end(), 1), 1000);
  }
}

TEST(Stop, ForEachLeavesOutWhatFollowsTheRequest) {
  for (const int threads : {1, 3}) {
    std::stop_source source;
    ThreadTeam team(threads, source.get_token());
    std::atomic<int> visits = 0;
    const auto visit = [&](std::size_t) {
      if (++visits == 10) source.request_stop();
    };
    // One part alone, and several.
    for (const std::size_t grain : {100'000u, 10u}) {
      source = std::stop_source();
      team.HeedStop(source.get_token());
      visits = 0;
      EXPECT_THROW(ForEach(team, 100'000, grain, visit), Stopped);
      EXPECT_LT(visits, 10 + 100 * threads);
    }
  }
}

}  // namespace
}  // namespace fascicle
