#ifndef FASCICLE_TESTS_SUPPORT_VOXEL_SCENES_H_
#define FASCICLE_TESTS_SUPPORT_VOXEL_SCENES_H_

#include <cmath>
#include <cstdint>

#include "core/geometry/voxel_grid.h"
#include "core/linalg/lanczos.h"
#include "core/voxel/voxel_field.h"

namespace fascicle::testing {

// A full box of the first material.
inline VoxelGrid BoxGrid(const GridIndex& size, const Vec3& spacing) {
  VoxelGrid grid = MakeVoxelGrid(size, spacing);
  grid.material.assign(grid.voxels(), 1);
  return grid;
}

// Two materials with holes, and factors between 0.5 and 1.5, pseudo-random with a fixed seed.
inline VoxelGrid SpongeGrid(const GridIndex& size, const Vec3& spacing) {
  VoxelGrid grid = MakeVoxelGrid(size, spacing);
  grid.stiffness.resize(grid.voxels());
  for (std::size_t v = 0; v < grid.voxels(); ++v) {
    const double chance = HashedUnit(v);
    grid.material[v] = chance < -0.4 ? 0 : chance < 0.4 ? 1 : 2;
    grid.stiffness[v] = static_cast<float>(1 + HashedUnit(v + 1'000'000));
  }
  return grid;
}

// A spindle along z from one end of the grid to the other, its radii in voxels.
inline VoxelGrid SpindleGrid(const GridIndex& size, double spacing, double end_radius, double belly_radius) {
  VoxelGrid grid = MakeVoxelGrid(size, Vec3::Constant(spacing));
  ForVoxels(grid, [&](std::size_t v, const GridIndex& at) {
    const double z = 2 * (at[2] + 0.5) / size[2] - 1, radius = end_radius + (belly_radius - end_radius) * (1 - z * z);
    const double x = at[0] + 0.5 - 0.5 * size[0], y = at[1] + 0.5 - 0.5 * size[1];
    grid.material[v] = std::hypot(x, y) <= radius ? 1 : 0;
  });
  return grid;
}

template <class S>
VoxelField<S> RandomField(std::int32_t nodes) {
  VoxelField<S> field(nodes);
  for (int d = 0; d < 3; ++d) {
    for (std::int32_t n = 0; n < nodes; ++n)
      field(n, d) = static_cast<S>(HashedUnit(3 * static_cast<std::uint64_t>(n) + d));
  }
  return field;
}

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_SUPPORT_VOXEL_SCENES_H_
