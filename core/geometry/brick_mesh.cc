#include "core/geometry/brick_mesh.h"

#include <utility>

#include "core/geometry/voxel_mesh.h"

namespace fascicle {

BrickMesh MakeBrickMesh(VoxelGrid grid, const std::stop_token& stop) {
  const VoxelMesh numbered(grid);
  ThrowIfStopped(stop);
  BrickMesh mesh;
  mesh.nodes.reserve(static_cast<std::size_t>(numbered.nodes()));
  for (const GridIndex& place : numbered.NodePlaces()) mesh.nodes.push_back(grid.CornerAt(place));
  ThrowIfStopped(stop);
  mesh.bricks.resize(static_cast<std::size_t>(numbered.voxels()));
  mesh.labels.resize(mesh.bricks.size());
  ForVoxels(numbered, [&](std::int32_t voxel, const GridIndex& place, const Brick& nodes) {
    ThrowIfStopped(stop);
    mesh.bricks[static_cast<std::size_t>(voxel)] = nodes;
    mesh.labels[static_cast<std::size_t>(voxel)] = grid.MaterialAt(place);
  });
  mesh.grid = std::move(grid);
  return mesh;
}

std::vector<Quad> BoundaryQuads(const BrickMesh& mesh, const std::stop_token& stop) {
  const VoxelGrid& grid = mesh.grid;
  std::vector<Quad> quads;
  ForVoxels(VoxelMesh(grid), [&](std::int32_t voxel, const GridIndex& place, const Brick&) {
    ThrowIfStopped(stop);
    const Brick& brick = mesh.bricks[static_cast<std::size_t>(voxel)];
    for (int side = 0; side < 6; ++side) {
      GridIndex next = place;
      next[side / 2] += side % 2 == 1 ? 1 : -1;
      if (grid.MaterialAt(next) != 0) continue;
      const auto& corners = kBrickSides[side];
      quads.push_back({brick[corners[0]], brick[corners[1]], brick[corners[2]], brick[corners[3]]});
    }
  });
  return quads;
}

}  // namespace fascicle
