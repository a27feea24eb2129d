#ifndef FASCICLE_CORE_VOXEL_TRANSFER_H_
#define FASCICLE_CORE_VOXEL_TRANSFER_H_

#include <vector>

#include "core/geometry/voxel_mesh.h"
#include "core/voxel/kernels.h"
#include "core/voxel/slabs.h"

namespace fascicle {

// Trilinear interpolation P from a coarse mesh to the mesh with half its spacing, all of whose voxels lie within coarse
// voxels. The same bits for any number of threads.
class VoxelTransfer {
 public:
  // The meshes must outlive the transfer.
  VoxelTransfer(const VoxelMesh& fine, const VoxelMesh& coarse,
                const VoxelKernels* kernels = &VoxelKernelsFor(PreferredInstructionSet()));

  // fine = P coarse.
  void Interpolate(const VoxelField<float>& coarse, ThreadTeam& team, VoxelField<float>& fine) const;
  // coarse = P^T fine.
  void Transpose(const VoxelField<float>& fine, ThreadTeam& team, VoxelField<float>& coarse) const;

 private:
  const VoxelMesh* coarse_;
  const VoxelKernels* kernels_;
  std::vector<TransferRun> runs_;
  std::vector<std::int32_t> slab_begin_;  // first run of each slab of the coarse mesh, and the end
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_VOXEL_TRANSFER_H_
