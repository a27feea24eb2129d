// Solids that move through their grids, against closed forms and conservation laws.
#include <gtest/gtest.h>

#include <cstdio>

#include "core/eulerian/elasticity.h"
#include "tests/support/solids.h"

namespace fascicle::testing {
namespace {

double EnergyOf(const EulerianBody& body, const EulerianState& state, ThreadTeam& team) {
  EulerianCells cells;
  NodeRoles roles;
  NodalForces forces;
  const std::array activation = {0.0};
  BodyControls controls;
  controls.activations = activation;
  UpdateCells(body, state, team, cells);
  SetForces(body, state, controls, cells, team, roles, forces);
  return KineticEnergy(state, forces) + ElasticEnergy(body, state, controls, cells);
}

// Through the grid by three cells: shape, momentum and energy are preserved.
TEST(EulerianMotion, FliesFreely) {
  ThreadTeam team(2);
  EulerianBody body = MakeSolid(24, true, 1e4, 0.4, team);
  const Vec3 velocity(0.5, -0.3, 0.2);
  SolidRun run(body, team);
  run.Begin(0, nullptr, [&](const Vec3&) { return velocity; });
  const double end = 3 * body.grid.spacing / 0.5;
  ASSERT_EQ(run.Step(end).problem, StepProblem::kNone);
  const auto momentum = [&] { return MomentumOf(body.grid, run.forces(), run.solid().v, team).sum; };
  const Vec3 first = momentum();
  while (run.state.time < end) {
    ASSERT_EQ(run.Step(end).problem, StepProblem::kNone);
  }
  double farthest = 0;
  for (std::size_t v = 0; v < run.solid().surface.size(); ++v) {
    farthest = std::max(farthest, (run.solid().surface[v] - body.shape.surface().nodes[v] - end * velocity).norm());
  }
  std::printf("flown by 3 cells: vertices off by %.2g cells, volume %.6f\n", farthest / body.grid.spacing,
              VolumeRatio(body, run.solid()));
  EXPECT_LT(farthest, 0.05 * body.grid.spacing);
  EXPECT_NEAR(VolumeRatio(body, run.solid()), 1, 1e-3);
  run.Step(2 * end);
  EXPECT_LT((momentum() - first).norm(), 0.01 * first.norm());
}

// A ball stretched by 1.1 and released, with volume preservation: the volume within its surface stays within 0.1 %. The
// energy changes as the solid moves through cells, less with finer cells.
TEST(EulerianMotion, AStretchedBallKeepsItsVolume) {
  ThreadTeam team(2);
  for (const auto& [cells, energy_bound] : {std::pair(20, 1.1), {32, 1.02}, {64, 1.005}}) {
    EulerianBody body = MakeSolid(cells, true, 2e4, 0.3, team);
    body.volume = VolumeTreatment::kPreserved;
    SolidRun run(body, team);
    const Vec3 stretch(1.1, 1 / std::sqrt(1.1), 1 / std::sqrt(1.1));
    run.Begin(0, [&](const Vec3& x) { return Vec3(x.cwiseQuotient(stretch)); });
    const EulerianState& state = run.solid();
    double first = 0, most = 0, worst = 0, least_length = 1, push = 0;
    while (run.state.time < 0.06) {
      const EulerianReport report = run.Step(0.06);
      ASSERT_EQ(report.problem, StepProblem::kNone) << run.state.time;
      worst = std::max(worst, std::abs(VolumeRatio(body, state) - 1));
      const double energy = EnergyOf(body, state, team);
      if (run.state.step == 1) first = energy;
      most = std::max(most, energy);
      push = std::max(push, MomentumOf(body.grid, run.forces(), state.v, team).sum.norm());
      double length = 0;
      for (const Vec3& x : state.surface) length = std::max(length, x[0]);
      least_length = std::min(least_length, 2 * length / kSide);
    }
    const double momentum = std::sqrt(2 * first * 1000 * body.shape.volume());
    std::printf(
        "ball at %d^3: volume within %.3f %%, energy at most %.3f of the first, momentum %.4f of what it holds, "
        "shortest %.3f\n",
        cells, 100 * worst, most / first, push / momentum, least_length);
    EXPECT_LT(worst, 1e-3);
    EXPECT_LT(most, energy_bound * first);
    EXPECT_LT(push, 0.01 * momentum);
    EXPECT_LT(least_length, 0.96);  // it passes the rest state
  }
}

// Crushed by forces towards its middle plane [Fan 2013, figure 6.1], with each treatment of volume.
TEST(EulerianMotion, ACrushedCubeKeepsItsVolumeIfAskedTo) {
  ThreadTeam team(2);
  double worst[3] = {};
  for (const VolumeTreatment treatment :
       {VolumeTreatment::kNone, VolumeTreatment::kDivergenceFree, VolumeTreatment::kPreserved}) {
    EulerianBody body = MakeSolid(16, false, 2e4, 0.3, team);
    body.volume = treatment;
    body.mass_damping = 10;
    body.force_fields = {TowardsMiddle(4e4, kSide / 5)};
    SolidRun run(body, team);
    double& largest = worst[static_cast<int>(treatment)];
    while (run.state.time < 0.1) {
      ASSERT_EQ(run.Step(0.1).problem, StepProblem::kNone) << run.state.time;
      largest = std::max(largest, std::abs(VolumeRatio(body, run.solid()) - 1));
    }
  }
  std::printf("volume changes by %.3f %% with none, %.3f %% with div v = 0, %.3f %% preserved\n", 100 * worst[0],
              100 * worst[1], 100 * worst[2]);
  EXPECT_GT(worst[0], 0.01);
  EXPECT_LT(worst[1], 0.002);
  EXPECT_LT(worst[2], 0.95 * worst[1]);  // div v = 0 does not correct what has drifted
}

// Hanging from above a row of nodes, without lateral strain (nu = 0): with P = mu (s - 1/s) = rho g Z at a distance Z
// from the lower end, s = p/2 + sqrt(1 + p^2/4), p = rho g Z / mu, and u the integral of s - 1.
TEST(EulerianMotion, ABlockHangsAsFarAsItShould) {
  ThreadTeam team(2);
  constexpr double kYoung = 2e4, kGravity = 8, kEnd = 0.3;
  double errors[2] = {};
  const int sizes[2] = {14, 28};
  for (int k = 0; k < 2; ++k) {
    EulerianBody body = MakeSolid(sizes[k], false, kYoung, 0, team);
    body.gravity = Vec3(0, 0, -kGravity);
    body.mass_damping = 70;  // half of critical
    HoldAbove(0.3142 * kSide, body);
    const double clamp = 0.31428571 * kSide;  // a row of nodes of both grids
    SolidRun run(body, team);
    while (run.state.time < kEnd) {
      ASSERT_EQ(run.Step(kEnd).problem, StepProblem::kNone) << run.state.time;
    }
    const EulerianState& state = run.solid();
    double sum = 0, count = 0, expected = 0;
    for (std::size_t v = 0; v < state.surface.size(); ++v) {
      if (body.shape.surface().nodes[v][2] > -0.5 * kSide + 1e-9) continue;
      sum += -0.5 * kSide - state.surface[v][2];
      ++count;
    }
    const double length = clamp + 0.5 * kSide;
    for (int i = 0; i < 1000; ++i) {
      const double p = 1000 * kGravity * (i + 0.5) / 1000 * length / (kYoung / 2);
      expected += (p / 2 + std::sqrt(1 + p * p / 4) - 1) * length / 1000;
    }
    errors[k] = std::abs(sum / count / expected - 1);
    std::printf("hanging at %d^3: %.4f mm, off by %.2f %%\n", sizes[k], 1e3 * sum / count, 100 * errors[k]);
  }
  EXPECT_LT(errors[1], 0.009);
  EXPECT_NEAR(std::log2(errors[0] / errors[1]), 1.67, 0.06);  // order, as measured
}

}  // namespace
}  // namespace fascicle::testing
