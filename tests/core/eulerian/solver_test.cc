// What steps promise: rest, the same bits, and what is said when a step fails.
#include "core/eulerian/solver.h"

#include <gtest/gtest.h>

#include <cstring>

#include "tests/support/solids.h"

namespace fascicle::testing {
namespace {

TEST(EulerianSolver, WhatRestsStays) {
  ThreadTeam team(2);
  const EulerianBody body = MakeSolid(16, false, 1e4, 0.4, team);
  EulerianSolver solver(body, team);
  EulerianState state = solver.InitialState();
  for (int k = 0; k < 30; ++k) ASSERT_EQ(solver.Step(1, state).problem, StepProblem::kNone);
  EXPECT_LT(CarrySurface(body, team, state), 1e-9);
  EXPECT_NEAR(VolumeRatio(body, state), 1, 1e-10);
}

std::string BitsOf(const EulerianState& state) {
  ArchiveWriter archive("test", 1);
  state.Save(archive);
  return archive.Finish();
}

TEST(EulerianSolver, TheSameBitsForAnyThreadsAndAfterALoad) {
  std::string bits[3];
  for (const int run : {0, 1, 2}) {
    ThreadTeam team(run == 1 ? 3 : 1);
    EulerianBody body = MakeSolid(14, false, 1e4, 0.3, team);
    body.volume = VolumeTreatment::kPreserved;
    body.gravity = Vec3(1, 2, -9);
    HoldAbove(0.3 * kSide, body);
    EulerianSolver solver(body, team);
    EulerianState state = solver.InitialState();
    for (int k = 0; k < 8; ++k) {
      if (run == 2 && k == 4) {
        const std::string saved = BitsOf(state);
        EulerianSolver fresh(body, team);
        state = fresh.InitialState();
        ArchiveReader archive(saved, "test", 1);
        state.Load(archive);
        ASSERT_TRUE(archive.AtEnd());
      }
      ASSERT_EQ(solver.Step(1, state).problem, StepProblem::kNone);
    }
    bits[run] = BitsOf(state);
  }
  EXPECT_EQ(bits[0], bits[1]);
  EXPECT_EQ(bits[0], bits[2]);
}

TEST(EulerianSolver, ABodyThatIsHeldAllOverRests) {
  ThreadTeam team(1);
  for (const bool implicit : {false, true}) {
    EulerianBody body = MakeSolid(14, false, 1e4, 0.3, team);
    body.volume = VolumeTreatment::kPreserved;
    body.implicit_elasticity = implicit;
    body.gravity = Vec3(0, 0, -9);
    HoldAbove(-1, body);
    EulerianSolver solver(body, team);
    EulerianState state = solver.InitialState();
    for (int k = 0; k < 3; ++k) ASSERT_EQ(solver.Step(1, state).problem, StepProblem::kNone);
    EXPECT_NEAR(VolumeRatio(body, state), 1, 1e-12);
    EXPECT_GT(solver.reactions()[0][2], 0.8 * 9);  // of a body of 1 kg
  }
}

// From rest, momentum is what gravity and the support gave.
TEST(EulerianSolver, ReactionsBalanceTheMomentum) {
  ThreadTeam team(2);
  for (const VolumeTreatment volume : {VolumeTreatment::kNone, VolumeTreatment::kPreserved}) {
    for (const bool implicit : {false, true}) {
      EulerianBody body = MakeSolid(14, false, 1e4, 0.3, team);
      body.volume = volume;
      body.implicit_elasticity = implicit;
      body.gravity = Vec3(1, 2, -9);
      HoldAbove(0.3 * kSide, body);
      EulerianSolver solver(body, team);
      EulerianState state = solver.InitialState();
      const EulerianReport report = solver.Step(1, state);
      ASSERT_EQ(report.problem, StepProblem::kNone);
      const Vec3 gained = MomentumOf(body.grid, solver.nodes(), state.v, team).sum;
      const Vec3 given = report.dt * (MassOf(solver.nodes(), team) * body.gravity + solver.reactions()[0]);
      EXPECT_GT(gained.norm(), 0.1 * report.dt);
      EXPECT_LT((gained - given).norm(), 1e-5 * gained.norm()) << implicit;
    }
  }
}

TEST(EulerianSolver, SaysThatTheSolidLeavesItsGridAndKeepsTheState) {
  ThreadTeam team(1);
  const EulerianBody body = MakeSolid(16, true, 1e4, 0.3, team);
  EulerianSolver solver(body, team);
  EulerianState state = solver.InitialState(nullptr, [](const Vec3&) { return Vec3(2, 0, 0); });
  EulerianReport report;
  for (int k = 0; k < 500 && report.problem == StepProblem::kNone; ++k) {
    const std::string before = BitsOf(state);
    report = solver.Step(1, state);
    if (report.problem != StepProblem::kNone) {
      EXPECT_EQ(BitsOf(state), before);
    }
  }
  EXPECT_EQ(report.problem, StepProblem::kLeftGrid);
  EXPECT_FALSE(report.bad_cells.empty());
  EXPECT_GT(state.time, 0.01);
}

}  // namespace
}  // namespace fascicle::testing
