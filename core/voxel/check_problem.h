#ifndef FASCICLE_CORE_VOXEL_CHECK_PROBLEM_H_
#define FASCICLE_CORE_VOXEL_CHECK_PROBLEM_H_

#include <vector>

#include "core/base/problems.h"
#include "core/voxel/model.h"

namespace fascicle {

// Everything that would leave a static problem without an answer, or with a wrong one: an empty or senseless grid,
// moduli out of range (nu -> 0.5), voxels of no material, supports and loads on what does not exist or that contradict
// each other, and parts that nothing holds, with their rigid motions named. Adds all of it; paths are `grid...`,
// `materials[m]...`, `supports[s]...`, `loads...`. may_fly: parts that nothing holds are right, as in steps in time.
void CheckVoxelProblem(const VoxelGrid& grid, const std::vector<VoxelMaterial>& materials,
                       const std::vector<VoxelSupport>& supports, const VoxelLoads& loads, Problems& problems,
                       bool may_fly = false);

}  // namespace fascicle

#endif  // FASCICLE_CORE_VOXEL_CHECK_PROBLEM_H_
