#include "core/voxel/dynamic_solver.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <numbers>

#include "core/voxel/static_solver.h"
#include "tests/support/voxel_scenes.h"

namespace fascicle {
namespace {

using testing::BoxGrid;
using testing::SpongeGrid;

constexpr double kDensity = 1060;
const VoxelMaterial kDynamicMuscle = {3e4, 0.4};

bool HaveSameBits(const VoxelField<double>& a, const VoxelField<double>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

// A cantilever, clamped at its left end.
struct Cantilever {
  explicit Cantilever(const GridIndex& size, VoxelRotation rotation = VoxelRotation::kSmall,
                      const VoxelMaterial& material = kDynamicMuscle)
      : grid(BoxGrid(size, Vec3::Constant(2e-3))),
        model(grid, {material}, Dilatation::kFull, rotation),
        supports({{NodesInBox(model.mesh(), {0, 0, 0}, {0, size[1], size[2]})}}),
        none(model.mesh().nodes()) {}
  VoxelGrid grid;
  VoxelModel model;
  std::vector<VoxelSupport> supports;
  VoxelField<double> none;  // neither force nor displacement
};

// The lowest frequency is that of the beam [Timoshenko, Young & Weaver 1974]: 1.8751^2/(2 pi L^2) sqrt(E I/(rho A)).
TEST(LowestMode, IsThatOfABeam) {
  const Cantilever body({40, 4, 6}, VoxelRotation::kSmall, {3e4, 0});
  ThreadTeam team(1);
  const VoxelMode mode = LowestMode(body.model, body.supports, kDensity, team);
  ASSERT_TRUE(mode.converged);
  const double length = 0.08, depth = 8e-3;
  const double beam =
      1.8751 * 1.8751 / (2 * std::numbers::pi * length * length) * std::sqrt(3e4 * depth * depth / 12 / kDensity);
  EXPECT_NEAR(mode.frequency, beam, 0.02 * beam);
  // It is the eigenvector: K v = w^2 M v.
  VoxelField<double> Kv(body.none.nodes());
  body.model.K().Apply(mode.shape, team, Kv);
  const VoxelDynamicSolver solver(body.model, body.supports, {.density = kDensity, .time_step = 1}, team);
  const double square = std::pow(2 * std::numbers::pi * mode.frequency, 2);
  double error = 0, size = 0;
  for (std::int32_t n = 0; n < Kv.nodes(); ++n) {
    if (mode.shape.At(n).isZero(0)) continue;
    error += (Kv.At(n) - square * solver.mass()[n] * mode.shape.At(n)).squaredNorm();
    size += Kv.At(n).squaredNorm();
  }
  EXPECT_LT(std::sqrt(error / size), 1e-3);
}

TEST(Dynamic, MassIsThatOfTheBody) {
  VoxelGrid grid = SpongeGrid({6, 5, 7}, {1e-3, 2e-3, 3e-3});
  KeepLargestIsland(grid);
  const VoxelModel model(grid, {kDynamicMuscle, kDynamicMuscle}, Dilatation::kFull);
  ThreadTeam team(1);
  const VoxelDynamicSolver solver(model, {}, {.density = kDensity, .time_step = 1e-3}, team);
  double mass = 0;
  for (const double m : solver.mass()) mass += m;
  EXPECT_NEAR(mass, kDensity * 6e-9 * model.mesh().voxels(), 1e-12 * mass);
}

// Released in its lowest mode, a body stays in it; each step multiplies (u_{n+1}, u_n) as the scheme's quadratic
// equation (1 + (w dt)^2 + a dt/2) z^2 - 2 z + 1 - a dt/2 = 0 determines: frequency and decay are exact for any step.
TEST(Dynamic, ReleasedInAModeFollowsTheSchemesOwnSolution) {
  const Cantilever body({20, 3, 3});
  ThreadTeam team(1);
  const VoxelMode mode = LowestMode(body.model, body.supports, kDensity, team, 1e-12);
  ASSERT_TRUE(mode.converged);
  const double w = 2 * std::numbers::pi * mode.frequency;
  for (const double damping : {0.0, 0.3 * w}) {
    for (const double part : {0.01, 0.2, 2.0}) {  // of a radian
      const double dt = part / w, half = damping * dt / 2;
      VoxelDynamicSolver solver(body.model, body.supports,
                                {.density = kDensity, .mass_damping = damping, .time_step = dt, .tolerance = 1e-13},
                                team);
      VoxelState state = solver.InitialState(&mode.shape);
      double now = 1, previous = 1;
      for (int step = 0; step < 12; ++step) {
        ASSERT_TRUE(solver.Step(body.none, body.none, state).iterations.converged);
        const double next = (2 * now - (1 - half) * previous) / (1 + part * part + half);
        previous = now;
        now = next;
      }
      double error = 0;
      for (std::size_t k = 0; k < body.none.size(); ++k) {
        error = std::max(error, std::abs(state.displacement.data()[k] - now * mode.shape.data()[k]));
      }
      EXPECT_LT(error, 1e-4) << "step " << part << ", damping " << damping;  // the mode is right to 1e-6
    }
  }
}

// The paper's dynamic release: a static load is removed. With small steps the tip vibrates with the lowest frequency
// and decays by exp(-a t/2); the frequency is measured by zero crossings.
TEST(Dynamic, ReleaseSwingsAtTheLowestFrequencyAndDecays) {
  const Cantilever body({20, 3, 4});
  ThreadTeam team(1);
  const VoxelMode mode = LowestMode(body.model, body.supports, kDensity, team);
  ASSERT_TRUE(mode.converged);
  const double period = 1 / mode.frequency, w = 2 * std::numbers::pi / period, damping = 0.2 * w, dt = period / 400;
  VoxelStaticSolver statics(body.model, body.supports, team);
  VoxelField<double> force(body.none.nodes());
  const std::int32_t tip = body.model.mesh().NodeAt({20, 1, 2});
  for (const GridIndex& at : NodesInBox(body.model.mesh(), {20, 0, 0}, {20, 3, 4}))
    force(body.model.mesh().NodeAt(at), 1) = 1e-4;
  const StaticSolution loaded = statics.Solve(force, body.none);
  VoxelDynamicSolver solver(body.model, body.supports, {.density = kDensity, .mass_damping = damping, .time_step = dt},
                            team);
  VoxelState state = solver.InitialState(&loaded.displacement);
  std::vector<double> crossings, peaks;
  double energy = loaded.energy, before = loaded.displacement(tip, 1), slope = 0;
  while (crossings.size() < 7) {
    ASSERT_LT(state.step, 2000);
    const VoxelStepReport report = solver.Step(body.none, body.none, state);
    ASSERT_TRUE(report.iterations.converged);
    // The energy never grows.
    EXPECT_LE(report.kinetic + report.elastic, energy * (1 + 1e-6));
    energy = report.kinetic + report.elastic;
    const double now = state.displacement(tip, 1);
    if (now * before < 0) crossings.push_back(state.time - dt * now / (now - before));
    if ((now - before) * slope < 0 && state.step > 2) peaks.push_back(std::abs(before));
    slope = now - before;
    before = now;
  }
  const double damped = std::sqrt(w * w - damping * damping / 4);
  // Higher modes shift single crossings.
  EXPECT_NEAR((crossings[6] - crossings[0]) / 6, std::numbers::pi / damped, 0.005 * std::numbers::pi / damped);
  const double rate = std::log((1 + w * w * dt * dt + damping * dt / 2) / (1 - damping * dt / 2)) / (2 * dt);
  const double expected = rate * 2 * std::numbers::pi / damped;
  ASSERT_GE(peaks.size(), 5u);
  EXPECT_NEAR(std::log(peaks[2] / peaks[4]), expected, 0.03 * expected);
}

// A free body conserves momentum, and rotates correctly if it may.
TEST(Dynamic, AFreeBodyFlies) {
  const Cantilever body({6, 4, 5});
  ThreadTeam team(1);
  VoxelField<double> velocity(body.none.nodes()), weight(body.none.nodes());
  for (std::int32_t n = 0; n < velocity.nodes(); ++n) velocity.Add(n, Vec3(0.1, -0.2, 0.3));
  const double dt = 1e-3;
  VoxelDynamicSolver solver(body.model, {}, {.density = kDensity, .time_step = dt, .tolerance = 1e-12}, team);
  for (std::int32_t n = 0; n < velocity.nodes(); ++n) weight.Add(n, solver.mass()[n] * Vec3(0, 0, -9.81));
  VoxelState state = solver.InitialState(nullptr, &velocity);
  for (int step = 0; step < 50; ++step) ASSERT_TRUE(solver.Step(weight, body.none, state).iterations.converged);
  // u_n = n dt v + n (n + 1)/2 dt^2 g.
  const Vec3 expected = 50 * dt * Vec3(0.1, -0.2, 0.3) + 25 * 51 * dt * dt * Vec3(0, 0, -9.81);
  for (std::int32_t n = 0; n < velocity.nodes(); ++n) {
    EXPECT_LT((state.displacement.At(n) - expected).norm(), 1e-9 * expected.norm());
  }
}

TEST(Dynamic, PrescribedComponentsFollowTheirValues) {
  const Cantilever body({8, 3, 3});
  ThreadTeam team(1);
  VoxelDynamicSolver solver(body.model, body.supports, {.density = kDensity, .mass_damping = 200, .time_step = 2e-3},
                            team);
  VoxelState state = solver.InitialState();
  VoxelField<double> moved(body.none.nodes());
  for (int step = 1; step <= 400; ++step) {
    const double by = 1e-5 * std::min(step, 100);
    for (const GridIndex& at : body.supports[0].nodes) moved(body.model.mesh().NodeAt(at), 2) = by;
    ASSERT_TRUE(solver.Step(body.none, moved, state).iterations.converged);
    EXPECT_EQ(state.displacement(body.model.mesh().NodeAt({0, 1, 1}), 2), by);
  }
  // In the end the whole body has followed.
  for (std::int32_t n = 0; n < moved.nodes(); ++n) EXPECT_NEAR(state.displacement(n, 2), 1e-3, 1e-6);
}

void SwingFor(int steps, const Cantilever& body, VoxelDynamicSolver& solver, VoxelState& state) {
  VoxelField<double> force(body.none.nodes());
  for (int k = 0; k < steps; ++k) {
    force(body.none.nodes() - 1, 1) = 5e-3 * std::cos(static_cast<double>(state.step));
    ASSERT_TRUE(solver.Step(force, body.none, state).iterations.converged);
  }
}

TEST(Dynamic, ASavedStateGoesOnWithTheSameBits) {
  for (const VoxelRotation rotation : {VoxelRotation::kSmall, VoxelRotation::kLarge}) {
    const Cantilever body({12, 4, 4}, rotation);
    ThreadTeam team(1);
    const DynamicSettings settings = {.density = kDensity, .time_step = 5e-3};
    VoxelDynamicSolver solver(body.model, body.supports, settings, team);
    VoxelState state = solver.InitialState();
    SwingFor(5, body, solver, state);
    ArchiveWriter writer("voxel", 1);
    state.Save(writer);
    const std::string bytes = writer.Finish();
    SwingFor(5, body, solver, state);

    VoxelDynamicSolver other(body.model, body.supports, settings, team);
    VoxelState loaded = other.InitialState();
    ArchiveReader reader(bytes, "voxel", 1);
    loaded.Load(reader);
    ASSERT_TRUE(reader.AtEnd());
    EXPECT_EQ(loaded.step, 5);
    SwingFor(5, body, other, loaded);
    EXPECT_EQ(loaded.time, state.time);
    EXPECT_EQ(loaded.iterations, state.iterations);
    EXPECT_TRUE(HaveSameBits(loaded.displacement, state.displacement));
    EXPECT_TRUE(HaveSameBits(loaded.previous, state.previous));
  }
}

TEST(Dynamic, HasTheSameBitsForAnyThreads) {
  for (const VoxelRotation rotation : {VoxelRotation::kSmall, VoxelRotation::kLarge}) {
    const Cantilever body({40, 40, 42}, rotation);
    ASSERT_GT(body.model.mesh().slabs().size(), 2u);
    std::vector<VoxelState> states;
    for (const int threads : {1, 3}) {
      ThreadTeam team(threads);
      VoxelDynamicSolver solver(body.model, body.supports, {.density = kDensity, .time_step = 2e-3}, team);
      states.push_back(solver.InitialState());
      SwingFor(2, body, solver, states.back());
    }
    EXPECT_TRUE(HaveSameBits(states[0].displacement, states[1].displacement));
  }
}

}  // namespace
}  // namespace fascicle
