// Profiles of runs, and their sum.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "server/jobs/job_manager.h"
#include "server/translate/translate.h"

namespace fascicle::server {
namespace {

using ::testing::ElementsAre;

void Sleep(Profile& profile, const char* outer, const char* inner = nullptr) {
  const StageTimer timer(&profile, outer);
  if (inner != nullptr) return Sleep(profile, inner);
  std::this_thread::sleep_for(std::chrono::milliseconds(2));
}

std::vector<std::string> NamesOf(const v1::Profile& profile) {
  std::vector<std::string> names;
  for (const v1::Profile::Stage& stage : profile.stages()) {
    names.push_back((stage.concurrent() ? "meanwhile " : "") + stage.name() + " " + std::to_string(stage.calls()));
  }
  return names;
}

TEST(EncodeProfileTest, HasTheStagesOfBothThreads) {
  RunProfile run;
  Sleep(run.working, "step", "force");
  Sleep(run.working, "step", "force");
  Sleep(run.storing, "step");
  const v1::Profile profile = EncodeProfile(run);
  EXPECT_THAT(NamesOf(profile), ElementsAre("step 2", "step/force 2", "meanwhile step 1"));
  EXPECT_EQ(profile.runs(), 1);
  EXPECT_GE(profile.stages(0).seconds(), 0.004);
  EXPECT_GE(profile.stages(0).seconds(), profile.stages(1).seconds());
  EXPECT_GE(profile.stages(2).seconds(), 0.002);
  EXPECT_GE(profile.wall_seconds(), profile.stages(0).seconds() + profile.stages(2).seconds());
}

TEST(EncodeProfileTest, AddsUpAndPutsWhatIsNewBehindWhatItIsPartOf) {
  RunProfile first;
  Sleep(first.working, "set-up", "scene");
  Sleep(first.working, "step", "force");
  Sleep(first.storing, "encode");
  first.working.NoteCpu(3);
  const v1::Profile of_first = EncodeProfile(first);

  RunProfile second;
  second.earlier = of_first.SerializeAsString();
  Sleep(second.working, "set-up", "checkpoint");
  Sleep(second.working, "step", "force");
  Sleep(second.working, "step", "stable step");
  Sleep(second.working, "end");
  Sleep(second.storing, "encode", "copy");
  second.working.NoteCpu(4);
  const v1::Profile sum = EncodeProfile(second);
  EXPECT_THAT(NamesOf(sum),
              ElementsAre("set-up 2", "set-up/scene 1", "set-up/checkpoint 1", "step 3", "step/force 2",
                          "step/stable step 1", "end 1", "meanwhile encode 2", "meanwhile encode/copy 1"));
  EXPECT_EQ(sum.runs(), 2);
  EXPECT_NEAR(sum.cpu_seconds(), 7, 0.5);
  EXPECT_EQ(sum.stages(1).seconds(), of_first.stages(1).seconds());
  EXPECT_GE(sum.stages(0).seconds(), of_first.stages(0).seconds() + 0.002);
  EXPECT_GE(sum.wall_seconds(), of_first.wall_seconds() + 0.01);
  // The same run, reported again.
  EXPECT_THAT(NamesOf(EncodeProfile(second)), NamesOf(sum));
}

TEST(EncodeProfileTest, TheCheckOfASceneComesBeforeItsFirstRun) {
  Profile check;
  Sleep(check, "check", "meshes");
  check.NoteCpu(2);
  const v1::Profile of_check = EncodeProfileOfCheck(check);
  EXPECT_EQ(of_check.runs(), 0);
  RunProfile run;
  run.earlier = of_check.SerializeAsString();
  Sleep(run.working, "step");
  const v1::Profile sum = EncodeProfile(run);
  EXPECT_THAT(NamesOf(sum), ElementsAre("check 1", "check/meshes 1", "step 1"));
  EXPECT_EQ(sum.runs(), 1);
  EXPECT_GE(sum.wall_seconds(), sum.stages(0).seconds() + sum.stages(2).seconds());
  EXPECT_GE(sum.cpu_seconds(), 2);
}

TEST(EncodeProfileTest, WhatCannotBeReadIsLeftOut) {
  RunProfile run;
  run.earlier = "\xff\xff\xff";
  Sleep(run.working, "step");
  const v1::Profile profile = EncodeProfile(run);
  EXPECT_EQ(profile.runs(), 1);
  EXPECT_THAT(NamesOf(profile), ElementsAre("step 1"));
}

}  // namespace
}  // namespace fascicle::server
