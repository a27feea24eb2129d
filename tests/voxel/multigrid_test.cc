#include "core/voxel/multigrid.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstring>

#include "core/voxel/conjugate_gradient.h"
#include "voxel_scenes.h"

namespace fascicle {
namespace {

using testing::BoxGrid;
using testing::RandomField;
using testing::SpongeGrid;

double Now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

TEST(Scratch, Cubes) {
  for (const std::int32_t n : {8, 16, 32, 64}) {
    const VoxelGrid grid = BoxGrid({n, n, n}, Vec3::Constant(64.0 / n));
    const VoxelMesh mesh(grid);
    for (const double nu : {0.3, 0.45}) {
      const double start = Now();
      const VoxelStiffness stiffness(mesh, {{1, nu}}, Dilatation::kFull);
      FixedComponents fixed(mesh.nodes(), 0);
      std::vector<std::size_t> numbers;
      VoxelField<double> x(mesh.nodes()), b(mesh.nodes());
      const auto places = mesh.NodePlaces();
      for (std::int32_t node = 0; node < mesh.nodes(); ++node) {
        if (places[node][2] != 0 && places[node][2] != n) continue;
        fixed[node] = 7;
        for (int d = 0; d < 3; ++d) numbers.push_back(d * x.stride() + node);
        if (places[node][2] == n) x(node, 2) = 0.64;
      }
      ThreadTeam team(1);
      VoxelMultigrid multigrid(mesh, stiffness, fixed, team);
      const double set_up = Now();
      const VoxelOperator<double> K(stiffness);
      const VoxelCgResult result = SolveVoxels(team, K, multigrid, numbers, b, 1e-8, 100, x);
      const double end = Now();
      VoxelField<double> f(mesh.nodes());
      K.Apply(x, team, f);
      double R = 0;
      for (std::int32_t node = 0; node < mesh.nodes(); ++node) {
        if (places[node][2] == n) R += f(node, 2);
      }
      std::printf("%d %g: R %.10g, %d iterations, set-up %.3f s, solve %.3f s, %s, %.0f bytes a voxel\n", n, nu, R,
                  result.iterations, set_up - start, end - set_up, multigrid.Description().c_str(),
                  static_cast<double>(multigrid.bytes()) / mesh.voxels());
      EXPECT_TRUE(result.converged);
    }
  }
}

}  // namespace
}  // namespace fascicle
