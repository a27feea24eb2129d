#ifndef FASCICLE_CORE_IMAGING_MASKS_H_
#define FASCICLE_CORE_IMAGING_MASKS_H_

#include "core/base/parallel.h"
#include "core/geometry/voxel_grid.h"

namespace fascicle {

// What is done to the solid voxels of a grid before they are simulated. Materials stay those that they were.

// Empties all voxels whose centres are no further from that of an empty one than `radius` [m], whatever the spacing:
// what is left are the places where a ball fits in. Outside of the box counts as solid.
void Erode(VoxelGrid& grid, double radius, ThreadTeam& team);

// Brings back the voxels of `whole` no further than `radius` [m] from those that are left in `grid`. After Erode this
// is an opening: thin bridges and sheets are gone, and so is what hung on them when its island was emptied in between.
void Restore(VoxelGrid& grid, const VoxelGrid& whole, double radius, ThreadTeam& team);

// Empties all but the islands (FindIslands) that hold one of these voxels, which must be inside of the box and solid.
void KeepIslandsOf(VoxelGrid& grid, const std::vector<GridIndex>& seeds);

// Makes empty voxels solid from where no way through empty voxels (by faces) leads to a side of the box: each hole gets
// the material that most of the faces around it have.
void FillHoles(VoxelGrid& grid);

// 2 |A and B| / (|A| + |B|) of the solid voxels of two grids of the same size [Dice 1945]; 1 where both are empty.
double DiceOverlap(const VoxelGrid& a, const VoxelGrid& b);

}  // namespace fascicle

#endif  // FASCICLE_CORE_IMAGING_MASKS_H_
