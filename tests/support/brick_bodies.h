#ifndef FASCICLE_TESTS_SUPPORT_BRICK_BODIES_H_
#define FASCICLE_TESTS_SUPPORT_BRICK_BODIES_H_

#include <algorithm>
#include <array>
#include <utility>

#include "core/geometry/brick_mesh.h"
#include "core/scene/scene.h"

namespace fascicle::testing {

// A box of voxels with one corner at the origin as a body, with the regions `x0` (its nodes at x = 0) and `x1` (at the
// other end).
inline Body VoxelBox(const Vec3& size, const GridIndex& divisions, Material material) {
  Body body;
  body.name = "box";
  VoxelGrid grid = MakeVoxelGrid(divisions, size.cwiseQuotient(Vec3(divisions[0], divisions[1], divisions[2])));
  std::fill(grid.material.begin(), grid.material.end(), std::uint8_t{1});
  body.shape = VoxelShape{MakeBrickMesh(std::move(grid)), {}};
  body.material = std::move(material);
  const std::vector<Quad> surface = BoundaryQuads(body.voxel().mesh);
  body.regions = {SelectRegion(body.voxel().mesh, surface, "x0", SideSelector{-Vec3::UnitX(), 0.1, 0}),
                  SelectRegion(body.voxel().mesh, surface, "x1", SideSelector{Vec3::UnitX(), 0.1, 0})};
  return body;
}

inline Scene VoxelScene(Body body) {
  Scene scene;
  scene.bodies = {std::move(body)};
  scene.method = Method::kVoxel;
  scene.duration = 1;
  scene.output.frame_interval = 1;
  return scene;
}

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_SUPPORT_BRICK_BODIES_H_
