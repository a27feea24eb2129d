// Which job is next.
#include "server/jobs/job_queue.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <random>
#include <utility>

namespace fascicle::server {
namespace {

using std::chrono::hours;
using std::chrono::seconds;
using ::testing::ElementsAre;

const JobQueue::Clock::time_point kStart = JobQueue::Clock::time_point() + hours(1);

// Takes all jobs, one after another, each of which needs `seconds` of one thread.
std::vector<std::string> RunAll(JobQueue& queue, seconds each = seconds(10)) {
  std::vector<std::string> order;
  JobQueue::Clock::time_point now = kStart;
  while (const std::optional<std::string> id = queue.Take(now)) {
    order.push_back(*id);
    queue.Started(*id, 1);
    now += each;
    queue.Stopped(*id, now);
  }
  return order;
}

TEST(JobQueue, JobsOfOneOwnerAreTakenInTheOrderOfTheirCreation) {
  JobQueue queue;
  for (const char* id : {"3", "1", "2"}) queue.Add(id, "ann", 0);
  EXPECT_THAT(RunAll(queue), ElementsAre("1", "2", "3"));
  EXPECT_EQ(queue.size(), 0);
}

TEST(JobQueue, PriorityComesFirst) {
  JobQueue queue;
  queue.Add("1", "ann", 0);
  queue.Add("2", "ann", 5);
  queue.Add("3", "bob", -5);
  queue.Add("4", "ann", 5);
  queue.SetPriority("4", 6);
  EXPECT_THAT(RunAll(queue), ElementsAre("4", "2", "1", "3"));
}

TEST(JobQueue, OwnersTakeTurnsHoweverManyJobsOneHas) {
  JobQueue queue;
  for (const char* id : {"1", "2", "3", "4"}) queue.Add(id, "ann", 0);
  for (const char* id : {"5", "6"}) queue.Add(id, "bob", 0);
  EXPECT_THAT(RunAll(queue), ElementsAre("1", "5", "2", "6", "3", "4"));
}

TEST(JobQueue, WhoHasUsedLessIsNextAndUseIsForgotten) {
  JobQueue queue;
  const auto use = [&](const std::string& owner, int threads, seconds time, JobQueue::Clock::time_point end) {
    queue.Add("0" + owner, owner, 0);
    EXPECT_EQ(queue.Take(end - time), "0" + owner);
    queue.Started("0" + owner, threads);
    queue.Stopped("0" + owner, end);
  };
  use("ann", 4, seconds(60), kStart);
  use("bob", 1, seconds(100), kStart);
  for (const auto& [id, owner] : {std::pair{"1", "ann"}, {"2", "bob"}, {"3", "cid"}}) queue.Add(id, owner, 0);
  EXPECT_EQ(queue.PlaceOf("1", kStart), 2);
  EXPECT_EQ(queue.PlaceOf("3", kStart), 0);
  for (const char* id : {"1", "2", "3"}) queue.Remove(id);
  // Two hours later ann's 240 s count as 60.
  use("bob", 1, seconds(100), kStart + hours(2));
  queue.Add("4", "bob", 0);
  queue.Add("5", "ann", 0);
  EXPECT_EQ(queue.Take(kStart + hours(2)), "5");
}

TEST(JobQueue, OwnersWithFewerRunningJobsComeFirstAndNoneHasMoreThanItsLimit) {
  JobQueue queue(2);
  for (const char* id : {"1", "2", "3", "4"}) queue.Add(id, "ann", 0);
  queue.Add("5", "bob", 0);
  EXPECT_EQ(queue.Take(kStart), "1");
  EXPECT_EQ(queue.PlaceOf("5", kStart), 0);
  EXPECT_EQ(queue.PlaceOf("2", kStart), 1);
  EXPECT_EQ(queue.Take(kStart), "5");
  EXPECT_EQ(queue.Take(kStart), "2");
  EXPECT_EQ(queue.Take(kStart), std::nullopt) << "ann has two, bob has no more";
  EXPECT_EQ(queue.PlaceOf("4", kStart), 1);
  EXPECT_EQ(queue.running(), 3);
  queue.Started("1", 3);
  EXPECT_EQ(queue.threads_in_use(), 5);
  EXPECT_EQ(queue.ThreadsOf("1"), 3);
  queue.Stopped("1", kStart);
  EXPECT_EQ(queue.Take(kStart), "3");
}

// Whatever happened before, the places are the order in which jobs are taken while none ends.
TEST(JobQueue, PlacesAreTheOrderInWhichJobsAreTaken) {
  std::mt19937 random(5);
  for (int round = 0; round < 50; ++round) {
    JobQueue queue;
    const auto pick = [&](unsigned count) { return static_cast<int>(random() % count); };
    for (int i = 0; i < 60; ++i)
      queue.Add(std::to_string(100 + i), std::string(1, static_cast<char>('a' + pick(4))), pick(2));
    for (int i = 0; i < 10; ++i) {
      const std::optional<std::string> id = queue.Take(kStart);
      queue.Started(*id, 1 + pick(3));
      if (pick(2) == 0) queue.Stopped(*id, kStart + seconds(pick(100)));
    }
    for (int i = 0; i < 20; ++i) queue.Remove(std::to_string(100 + pick(60)));
    const JobQueue::Clock::time_point now = kStart + seconds(100);
    std::map<std::string, int> places;
    for (int i = 0; i < 60; ++i) {
      const std::string id = std::to_string(100 + i);
      if (queue.Contains(id)) places[id] = queue.PlaceOf(id, now);
    }
    EXPECT_EQ(static_cast<int>(places.size()), queue.size());
    EXPECT_EQ(*queue.PlacesOfAll(now), JobQueue::Places(places.begin(), places.end()));
    for (int place = 0; queue.size() > 0; ++place) EXPECT_EQ(places.at(*queue.Take(now)), place);
  }
}

}  // namespace
}  // namespace fascicle::server
