// Properties of steps: rest, the same bits, one step for all solids, and reports of failures.
#include "core/eulerian/world.h"

#include <gtest/gtest.h>

#include <cstring>

#include "tests/support/solids.h"
#include "tests/support/stage_watch.h"

namespace fascicle::testing {
namespace {

TEST(EulerianWorld, WhatRestsStays) {
  ThreadTeam team(2);
  const EulerianBody body = MakeSolid(16, false, 1e4, 0.4, team);
  SolidRun run(body, team);
  for (int k = 0; k < 30; ++k) ASSERT_EQ(run.Step(1).problem, StepProblem::kNone);
  EXPECT_LT(FindSurface(body, team, run.solid()), 1e-9);
  EXPECT_NEAR(VolumeRatio(body, run.solid()), 1, 1e-10);
}

std::string BitsOf(const EulerianWorldState& state) {
  ArchiveWriter archive("test", 1);
  state.Save(archive);
  return archive.Finish();
}

// Two solids, one of them supported.
struct Pair {
  explicit Pair(ThreadTeam& team)
      : held(MakeSolid(14, false, 1e4, 0.3, team)), free(MakeSolid(12, true, 4e4, 0.3, team)) {
    for (EulerianBody* body : {&held, &free}) {
      body->volume = VolumeTreatment::kPreserved;
      body->gravity = Vec3(1, 2, -9);
    }
    HoldAbove(0.3 * kSide, held);
  }
  EulerianBody held, free;
};

TEST(EulerianWorld, TheSameBitsForAnyThreadsAndInAWorldThatIsLoaded) {
  std::string bits[3];
  for (const int run : {0, 1, 2}) {
    ThreadTeam team(run == 1 ? 3 : 1);
    const Pair pair(team);
    SolidRun first({&pair.held, &pair.free}, team);
    for (int k = 0; k < 4; ++k) ASSERT_EQ(first.Step(1).problem, StepProblem::kNone);
    first.solid().pose.position = Vec3(1, 2, 3);  // is part of the state
    const std::string saved = BitsOf(first.state);
    SolidRun second({&pair.held, &pair.free}, team);
    if (run == 2) {
      ArchiveReader archive(saved, "test", 1);
      second.state.Load(archive);
      ASSERT_TRUE(archive.AtEnd());
      ASSERT_EQ(second.solid().pose.position, Vec3(1, 2, 3));
      ASSERT_EQ(second.solid().reactions, first.solid().reactions);
    }
    SolidRun& last = run == 2 ? second : first;
    for (int k = 0; k < 4; ++k) ASSERT_EQ(last.Step(1).problem, StepProblem::kNone);
    bits[run] = BitsOf(last.state);
  }
  EXPECT_EQ(bits[0], bits[1]);
  EXPECT_EQ(bits[0], bits[2]);
}

// All solids make the step that is stable for the most restrictive one.
TEST(EulerianWorld, SolidsStepTogether) {
  ThreadTeam team(2);
  const Pair pair(team);
  const double of_held = SolidRun(pair.held, team).Propose(1).dt, of_free = SolidRun(pair.free, team).Propose(1).dt;
  SolidRun run({&pair.held, &pair.free}, team);
  EXPECT_EQ(run.Propose(1).dt, std::min(of_held, of_free));
  EXPECT_NE(of_held, of_free);
  // Uncoupled solids move as they would alone, to the tolerance of the joint program.
  SolidRun alone(pair.free, team);
  for (int k = 0; k < 5; ++k) {
    const double dt = alone.Propose(1).dt;
    ASSERT_NEAR(run.Propose(1).dt, dt, 1e-6 * dt) << "the softer solid would have the longer step";
    ASSERT_EQ(run.Step(1).problem, StepProblem::kNone);
    ASSERT_EQ(alone.Step(1).problem, StepProblem::kNone);
  }
  EXPECT_NEAR(run.state.time, alone.state.time, 1e-6 * alone.state.time);
  double moved = 0, off = 0;
  for (std::size_t v = 0; v < alone.solid().surface.size(); ++v) {
    moved = std::max(moved, (alone.solid().surface[v] - pair.free.shape.surface().nodes[v]).norm());
    off = std::max(off, (run.state.bodies[1].surface[v] - alone.solid().surface[v]).norm());
  }
  EXPECT_GT(moved, 1e-5);
  EXPECT_LT(off, 1e-4 * moved);
}

TEST(EulerianWorld, ABodyThatIsHeldAllOverRests) {
  ThreadTeam team(1);
  for (const bool implicit : {false, true}) {
    EulerianBody body = MakeSolid(14, false, 1e4, 0.3, team);
    body.volume = VolumeTreatment::kPreserved;
    body.implicit_elasticity = implicit;
    body.gravity = Vec3(0, 0, -9);
    HoldAbove(-1, body);
    SolidRun run(body, team);
    for (int k = 0; k < 3; ++k) ASSERT_EQ(run.Step(1).problem, StepProblem::kNone);
    EXPECT_NEAR(VolumeRatio(body, run.solid()), 1, 1e-12);
    EXPECT_GT(run.solid().reactions[0][2], 0.8 * 9);  // for a body of 1 kg
  }
}

// From rest, the momentum is the impulse of gravity and of the support.
TEST(EulerianWorld, ReactionsBalanceTheMomentum) {
  ThreadTeam team(2);
  for (const VolumeTreatment volume : {VolumeTreatment::kNone, VolumeTreatment::kPreserved}) {
    for (const bool implicit : {false, true}) {
      EulerianBody body = MakeSolid(14, false, 1e4, 0.3, team);
      body.volume = volume;
      body.implicit_elasticity = implicit;
      body.gravity = Vec3(1, 2, -9);
      HoldAbove(0.3 * kSide, body);
      SolidRun run(body, team);
      ASSERT_EQ(run.Step(1).problem, StepProblem::kNone);
      const double dt = run.state.time_step;
      const Vec3 gained = MomentumOf(body.grid, run.forces(), run.solid().v, team).sum;
      const Vec3 given = dt * (MassOf(run.forces(), team) * body.gravity + run.solid().reactions[0]);
      EXPECT_GT(gained.norm(), 0.1 * dt);
      EXPECT_LT((gained - given).norm(), 1e-5 * gained.norm()) << implicit;
    }
  }
}

TEST(EulerianWorld, SaysThatTheSolidLeavesItsGridAndKeepsTheState) {
  ThreadTeam team(1);
  const EulerianBody rests = MakeSolid(14, false, 1e4, 0.3, team), flies = MakeSolid(16, true, 1e4, 0.3, team);
  SolidRun run({&rests, &flies}, team);
  run.Begin(1, nullptr, [](const Vec3&) { return Vec3(2, 0, 0); });
  EulerianReport report;
  for (int k = 0; k < 500 && report.problem == StepProblem::kNone; ++k) {
    const std::string before = BitsOf(run.state);
    report = run.Step(1);
    if (report.problem != StepProblem::kNone) {
      EXPECT_EQ(BitsOf(run.state), before);
    }
  }
  EXPECT_EQ(report.problem, StepProblem::kLeftGrid);
  EXPECT_EQ(report.bad.body, 1u);
  EXPECT_FALSE(report.bad.elements.empty());
  EXPECT_GT(run.state.time, 0.01);
}

// After a stop at any stage, the state is unchanged, and the next step has the same bits as without the stop.
TEST(EulerianWorld, AStepThatIsStoppedLeavesNoTrace) {
  for (const char* stage : {"forces", "constraints", "advection of the map", "surface"}) {
    Profile profile;
    ThreadTeam team(2);
    const Pair pair(team);
    SolidRun run({&pair.held, &pair.free}, team, &profile);
    StopAtStage stop(profile, stage, 2);
    team.HeedStop(stop.token());
    std::string before;
    const auto step_until_stopped = [&] {
      while (run.state.time < 1) {
        before = BitsOf(run.state);
        if (run.Step(1).problem != StepProblem::kNone) return;
      }
    };
    EXPECT_THROW(step_until_stopped(), Stopped);
    team.HeedStop({});
    EXPECT_LE(CallsOf(profile, stage), stop.CallsAtStop());
    EXPECT_EQ(BitsOf(run.state), before);
    SolidRun undisturbed({&pair.held, &pair.free}, team);
    ArchiveReader archive(before, "test", 1);
    undisturbed.state.Load(archive);
    ASSERT_EQ(run.Step(1).problem, StepProblem::kNone);
    ASSERT_EQ(undisturbed.Step(1).problem, StepProblem::kNone);
    EXPECT_EQ(BitsOf(run.state), BitsOf(undisturbed.state)) << stage;
  }
}

}  // namespace
}  // namespace fascicle::testing
