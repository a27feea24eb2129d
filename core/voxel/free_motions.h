#ifndef FASCICLE_CORE_VOXEL_FREE_MOTIONS_H_
#define FASCICLE_CORE_VOXEL_FREE_MOTIONS_H_

#include <stop_token>
#include <string>
#include <vector>

#include "core/geometry/voxel_mesh.h"
#include "core/voxel/galerkin.h"

namespace fascicle {

// A part of a body that can move without strain, which makes K singular.
struct FreeMotion {
  GridIndex first_voxel = {};  // first voxel of the island
  std::int64_t voxels = 0;     // number of its voxels
  std::string motions;         // "moves along i, turns about j and k"
};

// All islands with rigid body modes that the supports leave free. Islands that touch in an edge or a corner constrain
// each other at the shared nodes (an edge is a hinge, a corner a ball joint). In a chain of more than 60 such islands,
// each must be supported by itself. Throws Stopped after a stop request.
std::vector<FreeMotion> FindFreeMotions(const VoxelGrid& grid, const VoxelMesh& mesh, const FixedComponents& fixed,
                                        const std::stop_token& stop = {});

}  // namespace fascicle

#endif  // FASCICLE_CORE_VOXEL_FREE_MOTIONS_H_
