#ifndef FASCICLE_CORE_IMAGING_MASKS_H_
#define FASCICLE_CORE_IMAGING_MASKS_H_

#include "core/base/parallel.h"
#include "core/geometry/voxel_grid.h"

namespace fascicle {

// What is done to the solid voxels of a grid, before they are simulated. Materials stay those that they were.

// Empties what no ball of that radius [m], inside of the solid voxels, reaches: thin bridges and sheets (opening). The
// ball is round in metres, whatever the spacing; outside of the box counts as solid.
void Open(VoxelGrid& grid, double radius, ThreadTeam& team);

// Empties all but the islands that hold one of these voxels; false when a voxel is outside of the box or empty.
bool KeepIslandsOf(VoxelGrid& grid, const std::vector<GridIndex>& seeds);

// Makes empty voxels solid from where no way through empty voxels (by faces) leads to the box's sides; each gets the
// material that most of its filled neighbours have. `in_slices`: the same in each plane of i and j by itself, before.
void FillHoles(VoxelGrid& grid, bool in_slices);

// 2 |A and B| / (|A| + |B|) of the solid voxels of two grids of the same size [Dice 1945]; 1 where both are empty.
double DiceOverlap(const VoxelGrid& a, const VoxelGrid& b);

}  // namespace fascicle

#endif  // FASCICLE_CORE_IMAGING_MASKS_H_
