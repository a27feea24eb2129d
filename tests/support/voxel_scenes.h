#ifndef FASCICLE_TESTS_SUPPORT_VOXEL_SCENES_H_
#define FASCICLE_TESTS_SUPPORT_VOXEL_SCENES_H_

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

// Two materials with holes, and factors between 0.5 and 1.5: all by chance, the same every time.
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
