#ifndef FASCICLE_CORE_VOXEL_VOXEL_OPERATOR_H_
#define FASCICLE_CORE_VOXEL_VOXEL_OPERATOR_H_

#include <memory>
#include <vector>

#include "core/geometry/voxel_mesh.h"
#include "core/voxel/brick.h"
#include "core/voxel/kernels.h"
#include "core/voxel/slabs.h"
#include "core/voxel/voxel_field.h"

namespace fascicle {

// Moduli and factors that define the stiffness of a mesh. Both precisions of an operator share them.
struct VoxelStiffness {
  // materials: the first is number 1 in the grid. scale: factor of each voxel's Young's modulus; empty: 1 everywhere.
  VoxelStiffness(const VoxelMesh& mesh, const std::vector<VoxelMaterial>& materials, Dilatation dilatation,
                 const std::vector<float>& scale_of_voxels = {});

  // Moduli by number of the material; all factors are 1.
  VoxelStiffness(const VoxelMesh& mesh, std::vector<BrickModuli<double>> moduli);

  const VoxelMesh* mesh;
  std::vector<BrickModuli<double>> moduli;  // by number of the material; entry 0 is unused
  // For each voxel [1], followed by zeros, because vector instructions read beyond the last. Zero for bricks with
  // matrices of their own.
  std::vector<float> scale;
};
// Stiffness factors of the solid voxels of a grid, in the order of its mesh.
std::vector<float> StiffnessOfVoxels(const VoxelGrid& grid);

// y = K x over the solid voxels of a mesh, matrix-free. S: double or float. The same bits for any number of threads and
// every instruction set. Const functions are thread-safe if each thread has its own team.
template <class S>
class VoxelOperator {
 public:
  // The mesh and the stiffness must outlive the operator.
  explicit VoxelOperator(const VoxelStiffness& stiffness,
                         const VoxelKernels* kernels = &VoxelKernelsFor(PreferredInstructionSet()));

  // x and y are different fields of the mesh; y is overwritten [N, for x in m].
  void Apply(const VoxelField<S>& x, ThreadTeam& team, VoxelField<S>& y) const;
  // The part of one slab, for loops over slabs with further work (ForSlabs).
  void ApplySlab(std::size_t slab, const VoxelField<S>& x, VoxelField<S>& y) const;

  // The kernels' arguments for y += ... of one slab.
  ProductTask<S> TaskOf(std::size_t slab, const VoxelField<S>& x, VoxelField<S>& y) const;
  const VoxelMesh& mesh() const { return *stiffness_->mesh; }
  const VoxelKernels& kernels() const { return *kernels_; }

 private:
  const VoxelStiffness* stiffness_;
  const VoxelKernels* kernels_;
  std::vector<BrickModuli<S>> moduli_;
  BrickShape<S> shape_;
};

// The diagonal of K for every node, without bricks that have their own matrices [N/m].
VoxelField<float> DiagonalOf(const VoxelStiffness& stiffness);

}  // namespace fascicle

#endif  // FASCICLE_CORE_VOXEL_VOXEL_OPERATOR_H_
