#ifndef FASCICLE_CORE_VOXEL_COARSE_AND_FINE_H_
#define FASCICLE_CORE_VOXEL_COARSE_AND_FINE_H_

#include <vector>

#include "core/geometry/voxel_mesh.h"
#include "core/voxel/voxel_field.h"

namespace fascicle {

// Displacements of a coarse level at the nodes of a finer one, by trilinear interpolation in the coarse voxel that
// contains a fine node. If that voxel is not solid (below the fraction threshold), the nearest solid neighbour is
// extrapolated; if there is none, the displacement is undefined.
struct InterpolatedField {
  VoxelField<double> values;  // zero where undefined
  std::vector<bool> defined;  // for each fine node
};
// ratio >= 1: fine voxels along an edge of a coarse voxel. Both grids start at the same corner (Coarsen).
InterpolatedField InterpolateToFine(const VoxelMesh& coarse, const VoxelField<double>& u, const VoxelMesh& fine,
                                    int ratio);

// Error of coarse displacements relative to the fine solution.
struct CoarseError {
  VoxelField<double> field;   // interpolated minus fine; zero where undefined [m]
  double relative = 0;        // rms error over the rms of the fine solution at the same nodes [1]
  double largest = 0;         // [m]
  std::int32_t left_out = 0;  // nodes without an interpolated value
};
CoarseError ErrorOfCoarse(const InterpolatedField& interpolated, const VoxelField<double>& fine);

}  // namespace fascicle

#endif  // FASCICLE_CORE_VOXEL_COARSE_AND_FINE_H_
