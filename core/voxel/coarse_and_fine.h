#ifndef FASCICLE_CORE_VOXEL_COARSE_AND_FINE_H_
#define FASCICLE_CORE_VOXEL_COARSE_AND_FINE_H_

#include <vector>

#include "core/geometry/voxel_mesh.h"
#include "core/voxel/voxel_field.h"

namespace fascicle {

// A level's displacements at the nodes of a finer one: by trilinear interpolation in the coarse voxel that a fine node
// is in; where that is not solid (a fraction threshold took it), by the trilinear function of the nearest solid one
// among its neighbours; where there is none, none.
struct CarriedField {
  VoxelField<double> values;  // zero where not carried
  std::vector<bool> carried;  // of each fine node
};
// ratio >= 1: fine voxels along an edge of a coarse one; both grids start at the same corner (Coarsen).
CarriedField CarryToFine(const VoxelMesh& coarse, const VoxelField<double>& u, const VoxelMesh& fine, int ratio);

// How far coarse displacements are from the fine solution.
struct CoarseError {
  VoxelField<double> field;   // carried minus fine; zero where not carried [m]
  double relative = 0;        // root of the sum of its squares, over that of the fine solution at the same nodes [1]
  double largest = 0;         // [m]
  std::int32_t left_out = 0;  // nodes that nothing was carried to
};
CoarseError ErrorOfCoarse(const CarriedField& carried, const VoxelField<double>& fine);

}  // namespace fascicle

#endif  // FASCICLE_CORE_VOXEL_COARSE_AND_FINE_H_
