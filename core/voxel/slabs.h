#ifndef FASCICLE_CORE_VOXEL_SLABS_H_
#define FASCICLE_CORE_VOXEL_SLABS_H_

#include <algorithm>

#include "core/geometry/voxel_mesh.h"
#include "core/voxel/voxel_field.h"

// Parallel sums over voxels in an order that depends on the mesh only; see VoxelSlab.
namespace fascicle {

// Calls body(slab) for the even slabs of a mesh in parallel, then for the odd ones.
template <class Body>
void ForSlabs(const VoxelMesh& mesh, ThreadTeam& team, const Body& body) {
  const std::size_t slabs = mesh.slabs().size();
  for (std::size_t parity = 0; parity < 2; ++parity) {
    team.For((slabs + 1 - parity) / 2, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t s = begin; s < end; ++s) body(2 * s + parity);
    });
  }
}

// Sets y to zero where slab s is the first to add to it, in the order of ForSlabs.
template <class S>
void ClearSlab(const VoxelMesh& mesh, std::size_t s, VoxelField<S>& y) {
  const VoxelSlab& slab = mesh.slabs()[s];
  const std::int32_t begin = s % 2 == 0 ? slab.first_node : slab.first_inner;
  const std::int32_t end = s % 2 == 0 ? slab.end_node : slab.end_inner;
  if (begin >= end) return;  // a slab of one layer has no inner nodes
  for (int d = 0; d < 3; ++d) std::fill(y.component(d) + begin, y.component(d) + end, S{0});
}

}  // namespace fascicle

#endif  // FASCICLE_CORE_VOXEL_SLABS_H_
