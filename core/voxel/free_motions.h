#ifndef FASCICLE_CORE_VOXEL_FREE_MOTIONS_H_
#define FASCICLE_CORE_VOXEL_FREE_MOTIONS_H_

#include <string>
#include <vector>

#include "core/geometry/voxel_mesh.h"
#include "core/voxel/galerkin.h"

namespace fascicle {

// A part of a body that can move without strain: K has no inverse.
struct FreeMotion {
  GridIndex first_voxel = {};  // of the island
  std::int64_t voxels = 0;     // in it
  std::string motions;         // "moves along i, turns about j and k"
};

// All islands that supports leave free to move as rigid bodies. Islands that touch in an edge or a corner hold each
// other in the nodes that they share (two of these are a hinge, one is a ball joint); of a chain of more than 60 such
// islands each must be held by itself.
std::vector<FreeMotion> FindFreeMotions(const VoxelGrid& grid, const VoxelMesh& mesh, const FixedComponents& fixed);

}  // namespace fascicle

#endif  // FASCICLE_CORE_VOXEL_FREE_MOTIONS_H_
