#ifndef FASCICLE_CORE_GEOMETRY_BRICK_MESH_H_
#define FASCICLE_CORE_GEOMETRY_BRICK_MESH_H_

#include <array>
#include <cstdint>
#include <stop_token>
#include <vector>

#include "core/geometry/voxel_grid.h"

namespace fascicle {

using Brick = std::array<std::int32_t, 8>;  // node indices; corner c is at (c & 1, c >> 1 & 1, c >> 2) along i, j, k
using Quad = std::array<std::int32_t, 4>;   // node indices; counter-clockwise seen from outside

// Corners of the six sides -i, +i, -j, +j, -k, +k of a brick, counter-clockwise seen from outside.
inline constexpr std::array<std::array<int, 4>, 6> kBrickSides = {
    {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};

// The solid voxels of a grid and their corners as explicit lists, numbered like those of VoxelMesh. Plain data.
struct BrickMesh {
  VoxelGrid grid;
  std::vector<Vec3> nodes;  // [m]
  std::vector<Brick> bricks;
  std::vector<std::int32_t> labels;  // material of each brick in the grid
};

// `grid` has at most 2^31 - 1 solid voxels. Throws Stopped after a stop request.
BrickMesh MakeBrickMesh(VoxelGrid grid, const std::stop_token& stop = {});

// Sides that belong to one brick only, ordered by brick, then by side. Throws Stopped after a stop request.
std::vector<Quad> BoundaryQuads(const BrickMesh& mesh, const std::stop_token& stop = {});

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_BRICK_MESH_H_
