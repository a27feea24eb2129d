#ifndef FASCICLE_CORE_VOXEL_CHECK_PROBLEM_H_
#define FASCICLE_CORE_VOXEL_CHECK_PROBLEM_H_

#include <vector>

#include "core/base/problems.h"
#include "core/voxel/model.h"

namespace fascicle {

// Reports everything that would leave a static problem without a solution, or give a wrong one: an empty or invalid
// grid, moduli out of range (nu -> 0.5), voxels without a material, supports and loads on nodes that do not exist or
// that contradict each other, and unsupported parts with their rigid body modes. Paths are `grid...`,
// `materials[m]...`, `supports[s]...`, `loads...`. may_fly: unsupported parts are allowed, as in dynamics.
void CheckVoxelProblem(const VoxelGrid& grid, const std::vector<VoxelMaterial>& materials,
                       const std::vector<VoxelSupport>& supports, const VoxelLoads& loads, Problems& problems,
                       bool may_fly = false);

}  // namespace fascicle

#endif  // FASCICLE_CORE_VOXEL_CHECK_PROBLEM_H_
