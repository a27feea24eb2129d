#ifndef FASCICLE_CORE_IMAGING_MASKS_H_
#define FASCICLE_CORE_IMAGING_MASKS_H_

#include <stop_token>

#include "core/base/parallel.h"
#include "core/geometry/voxel_grid.h"

namespace fascicle {

// Morphological operations on the solid voxels of a grid before simulation. Voxels keep their materials. Functions that
// take a team or a stop token throw Stopped after a stop request; the grid is then as it was.

// Erosion: empties all voxels whose centres are within `radius` [m] of that of an empty voxel, whatever the spacing.
// What remains are the centres of balls that fit into the body. Everything outside of the grid counts as solid.
void Erode(VoxelGrid& grid, double radius, ThreadTeam& team);

// Restores the voxels of `whole` within `radius` [m] of the solid voxels of `grid`. After Erode this completes an
// opening: thin bridges and sheets are removed, together with islands that have been emptied in between.
void Restore(VoxelGrid& grid, const VoxelGrid& whole, double radius, ThreadTeam& team);

// Empties all islands (FindIslands) except for those that contain one of these voxels, which must be solid.
void KeepIslandsOf(VoxelGrid& grid, const std::vector<GridIndex>& seeds, const std::stop_token& stop = {});

// Fills holes: empty voxels that are not face-connected to the boundary of the grid. Each hole gets the material that
// is most frequent among the adjacent faces.
void FillHoles(VoxelGrid& grid, const std::stop_token& stop = {});

// Dice coefficient 2 |A and B| / (|A| + |B|) of the solid voxels of two grids of the same size [Dice 1945]; 1 if both
// are empty.
double DiceOverlap(const VoxelGrid& a, const VoxelGrid& b);

}  // namespace fascicle

#endif  // FASCICLE_CORE_IMAGING_MASKS_H_
