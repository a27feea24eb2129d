#include "core/base/profile.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <string>
#include <thread>
#include <vector>

namespace fascicle {
namespace {

using std::chrono::milliseconds;
using ::testing::ElementsAre;

std::vector<std::string> NamesOf(const std::vector<ProfileStage>& stages) {
  std::vector<std::string> names;
  for (const ProfileStage& stage : stages) names.push_back(stage.name + " " + std::to_string(stage.calls));
  return names;
}

double SecondsOf(const Profile& profile, const std::string& name) {
  for (const ProfileStage& stage : profile.Stages()) {
    if (stage.name == name) return stage.seconds;
  }
  ADD_FAILURE() << "no stage " << name;
  return 0;
}

void Sleep(Profile* profile, const char* name, milliseconds time) {
  const StageTimer timer(profile, name);
  std::this_thread::sleep_for(time);
}

TEST(ProfileTest, IsATreeOfStagesByWhereTheyWereEntered) {
  Profile profile;
  for (int i = 0; i < 3; ++i) {
    const StageTimer step(&profile, "step");
    if (i == 1) const StageTimer rare(&profile, "rare");
    for (int k = 0; k < 2; ++k) {
      const StageTimer force(&profile, "force");
      const StageTimer gather(&profile, "gather");
    }
  }
  const StageTimer force(&profile, "force");
  EXPECT_THAT(NamesOf(profile.Stages()),
              ElementsAre("step 3", "step/force 6", "step/force/gather 6", "step/rare 1", "force 1"));
}

TEST(ProfileTest, TellsNamesByTheirTextAndNotByTheirPlaceInMemory) {
  Profile profile;
  const char one[] = "stage", two[] = "stage";
  { const StageTimer timer(&profile, one); }
  { const StageTimer timer(&profile, two); }
  EXPECT_THAT(NamesOf(profile.Stages()), ElementsAre("stage 2"));
}

TEST(ProfileTest, TimesAStageWithItsParts) {
  Profile profile;
  {
    const StageTimer timer(&profile, "whole");
    Sleep(&profile, "part", milliseconds(30));
    Sleep(&profile, "part", milliseconds(20));
    std::this_thread::sleep_for(milliseconds(10));
  }
  const double whole = SecondsOf(profile, "whole"), part = SecondsOf(profile, "whole/part");
  EXPECT_GE(part, 0.05);
  EXPECT_GE(whole, part + 0.01);
  EXPECT_GE(profile.wall_seconds(), whole);
}

TEST(ProfileTest, AStageAtWorkCountsUpToNow) {
  Profile profile;
  const StageTimer timer(&profile, "long");
  std::this_thread::sleep_for(milliseconds(5));
  const double early = SecondsOf(profile, "long");
  EXPECT_GE(early, 0.005);
  std::this_thread::sleep_for(milliseconds(5));
  EXPECT_GE(SecondsOf(profile, "long"), early + 0.005);
}

TEST(ProfileTest, IsLeftByExceptionsToo) {
  Profile profile;
  try {
    const StageTimer outer(&profile, "outer");
    const StageTimer inner(&profile, "inner");
    throw 1;
  } catch (int) {
  }
  { const StageTimer next(&profile, "next"); }
  EXPECT_THAT(NamesOf(profile.Stages()), ElementsAre("outer 1", "outer/inner 1", "next 1"));
}

TEST(ProfileTest, WithoutAProfileNothingHappens) {
  const StageTimer timer(nullptr, "nothing");
  Profile profile;
  EXPECT_TRUE(profile.Stages().empty());
}

TEST(ProfileTest, StagesBeyondItsRoomBelongToTheOneTheyArePartOf) {
  std::vector<std::string> names;
  Profile profile;
  for (int i = 0; i < 100; ++i) names.push_back("stage " + std::to_string(i));
  const StageTimer all(&profile, "all");
  for (const std::string& name : names) Sleep(&profile, name.c_str(), milliseconds(0));
  const std::vector<ProfileStage> stages = profile.Stages();
  EXPECT_EQ(stages.size(), 64u);
  EXPECT_EQ(stages.back().name, "all/stage 62");
  Sleep(&profile, "stage 3", milliseconds(0));  // the existing ones continue
  EXPECT_EQ(profile.Stages()[4].calls, 2);
}

TEST(ProfileTest, ProcessorTimeIsThatOfWorkAndNotOfWaiting) {
  Profile profile;
  const auto begin = std::chrono::steady_clock::now();
  volatile double sum = 0;
  profile.NoteCpu();
  const double before = profile.cpu_seconds();
  while (profile.cpu_seconds() < before + 0.02 && std::chrono::steady_clock::now() - begin < std::chrono::seconds(20)) {
    for (int i = 0; i < 1000; ++i) sum = sum + i;
    profile.NoteCpu();
  }
  const double worked = profile.cpu_seconds();
  EXPECT_GE(worked, before + 0.02);
  EXPECT_LE(worked, profile.wall_seconds());
  std::this_thread::sleep_for(milliseconds(50));
  profile.NoteCpu(7);
  EXPECT_GE(profile.cpu_seconds(), worked + 7);
  EXPECT_LT(profile.cpu_seconds(), worked + 7 + 0.025);
}

TEST(ProfileTest, OfAThreadToBeStartedCountsAllItsProcessorTime) {
  Profile of_new(0);
  volatile double sum = 0;
  for (int i = 0; i < 10'000'000; ++i) sum = sum + i;  // this thread's work is separate from the other's
  std::thread([&] { of_new.NoteCpu(); }).join();
  EXPECT_GT(of_new.cpu_seconds(), 0);
  EXPECT_LT(of_new.cpu_seconds(), 0.01);
}

TEST(ProfileTest, AnyThreadMayReadWhileStagesGoOn) {
  Profile profile;
  std::atomic<bool> done = false;
  std::thread reader([&] {
    std::int64_t calls = 0;
    while (!done) {
      for (const ProfileStage& stage : profile.Stages()) {
        EXPECT_GE(stage.seconds, 0);
        EXPECT_LE(stage.seconds, profile.wall_seconds());
        if (stage.name != "step") continue;
        EXPECT_GE(stage.calls, calls);
        calls = stage.calls;
      }
    }
  });
  for (int i = 0; i < 100'000; ++i) {
    const StageTimer step(&profile, "step");
    const StageTimer force(&profile, "force");
  }
  done = true;
  reader.join();
  EXPECT_THAT(NamesOf(profile.Stages()), ElementsAre("step 100000", "step/force 100000"));
}

}  // namespace
}  // namespace fascicle
