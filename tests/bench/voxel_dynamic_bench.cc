// The paper's dynamic release [Zhu, Chen & Kaufman 1998, 6: 219 voxels, 450 nodes, 22 frames in 0.76 s on a 195 MHz
// R10000]: time per frame of 1/60 s for bodies with about as many voxels.
#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "core/voxel/dynamic_solver.h"
#include "core/voxel/static_solver.h"
#include "ratio.h"
#include "tests/support/voxel_scenes.h"

namespace fascicle::bench {
namespace {

constexpr int kFrames = 22;

// A spindle with at least that many voxels, four times as long as thick; 0.2 m long.
VoxelGrid Spindle(std::int64_t voxels) {
  for (std::int32_t length = 4;; ++length) {
    const std::int32_t width = length / 3 + 1;
    const VoxelGrid grid = testing::SpindleGrid({width, width, length}, 0.2 / length, 0.05 * length, 0.15 * length);
    if (std::count(grid.material.begin(), grid.material.end(), 1) >= voxels) return grid;
  }
}

// Bent by a force at its top, then released.
bool Release(std::int64_t voxels, VoxelRotation rotation, int threads) {
  VoxelGrid grid = Spindle(voxels);
  KeepLargestIsland(grid);
  const VoxelModel model(grid, {{3e4, 0.45}}, Dilatation::kMean, rotation);
  const VoxelMesh& mesh = model.mesh();
  const std::int32_t all = 1 << 20, top = grid.size[2];
  const std::vector<VoxelSupport> supports = {{NodesInBox(mesh, {0, 0, 0}, {all, all, 0})}};
  VoxelLoads loads;
  loads.nodal_forces = {{NodesInBox(mesh, {0, 0, top}, {all, all, top}), Vec3(0.05, 0, 0)}};
  ThreadTeam team(threads);
  VoxelStaticSolver statics(model, supports, team);
  const StaticSolution loaded = statics.Solve(loads, {.max_iterations = 5000});
  if (!loaded.iterations.converged) return false;
  VoxelDynamicSolver solver(model, supports,
                            {.density = 1060, .mass_damping = 4, .time_step = 1.0 / 60, .tolerance = 1e-6}, team);
  VoxelState state = solver.InitialState(&loaded.displacement);
  const VoxelField<double> none(mesh.nodes());
  std::vector<double> times, cpu_times;
  bool converged = true;
  for (int frame = 0; frame < kFrames; ++frame) {
    const Duration time = DurationOf([&] { converged &= solver.Step(none, none, state).iterations.converged; });
    times.push_back(time.wall);
    cpu_times.push_back(time.cpu);
  }
  std::printf(
      "%d voxels, %d nodes, %s rotation, %d threads: %.2f ms a frame, %.2f of CPU (slowest %.2f): %.0f frames a "
      "second, "
      "%.1f iterations a frame\n",
      mesh.voxels(), mesh.nodes(), rotation == VoxelRotation::kSmall ? "small" : "large", threads, 1e3 * Median(times),
      1e3 * Median(cpu_times), 1e3 * *std::max_element(cpu_times.begin(), cpu_times.end()), 1 / Median(times),
      static_cast<double>(state.iterations) / kFrames);
  return converged;
}

int Main() {
  bool converged = true;
  for (const std::int64_t voxels : {219, 1840, 14578}) {
    for (const VoxelRotation rotation : {VoxelRotation::kSmall, VoxelRotation::kLarge})
      converged &= Release(voxels, rotation, 1);
  }
  return converged ? EXIT_SUCCESS : EXIT_FAILURE;
}

}  // namespace
}  // namespace fascicle::bench

int main() { return fascicle::bench::Main(); }
