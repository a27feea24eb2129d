#include "core/voxel/model.h"

#include <algorithm>

#include "core/base/check.h"

namespace fascicle {
namespace {

std::int32_t CheckedNode(const VoxelMesh& mesh, const GridIndex& at) {
  const std::int32_t node = mesh.NodeAt(at);
  FASCICLE_CHECK(node >= 0, "CheckVoxelProblem has checked the nodes of loads");
  return node;
}

}  // namespace

void AddForces(const VoxelModel& model, const VoxelLoads& loads, VoxelField<double>& f) {
  const VoxelMesh& mesh = model.mesh();
  for (const VoxelNodalForce& force : loads.nodal_forces) {
    const Vec3 share = force.total / static_cast<double>(force.nodes.size());
    for (const GridIndex& at : force.nodes) f.Add(CheckedNode(mesh, at), share);
  }
  for (const VoxelTraction& load : loads.tractions) {
    for (const VoxelFace& face : load.faces) {
      const int axis = face.side / 2;
      const Vec3 share = 0.25 * mesh.spacing().prod() / mesh.spacing()[axis] * load.traction;
      for (int c = 0; c < 8; ++c) {
        if ((c >> axis & 1) != face.side % 2) continue;
        f.Add(CheckedNode(mesh, {face.voxel[0] + (c & 1), face.voxel[1] + (c >> 1 & 1), face.voxel[2] + (c >> 2)}),
              share);
      }
    }
  }
  if (loads.body_force.isZero(0)) return;
  const Vec3 share = mesh.spacing().prod() / 8 * loads.body_force;
  ForVoxels(mesh, [&](std::int32_t, const GridIndex&, const std::array<std::int32_t, 8>& nodes) {
    for (const std::int32_t node : nodes) f.Add(node, share);
  });
}

std::vector<GridIndex> NodesInBox(const VoxelMesh& mesh, const GridIndex& low, const GridIndex& high) {
  std::vector<GridIndex> nodes;
  for (const NodeRun& run : mesh.node_runs()) {
    if (run.j < low[1] || run.j > high[1] || run.k < low[2] || run.k > high[2]) continue;
    const std::int32_t end = std::min(run.i + run.length, high[0] + 1);
    for (std::int32_t i = std::max(run.i, low[0]); i < end; ++i) nodes.push_back({i, run.j, run.k});
  }
  return nodes;
}

std::vector<VoxelFace> OuterFaces(const VoxelGrid& grid, int side, const GridIndex& low, const GridIndex& high) {
  std::vector<VoxelFace> faces;
  ForVoxels(grid, [&](std::size_t v, const GridIndex& at) {
    if (grid.material[v] == 0) return;
    for (int d = 0; d < 3; ++d) {
      if (at[d] < low[d] || at[d] > high[d]) return;
    }
    GridIndex beyond = at;
    beyond[side / 2] += side % 2 == 0 ? -1 : 1;
    if (grid.MaterialAt(beyond) == 0) faces.push_back({at, side});
  });
  return faces;
}

}  // namespace fascicle
