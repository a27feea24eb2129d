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

// What the stiffness of a mesh is made of. Both precisions of an operator share one.
struct VoxelStiffness {
  // Of a grid's materials, the first for 1 in the grid. scale: factor of each voxel's Young's modulus, none for 1
  // everywhere.
  VoxelStiffness(const VoxelMesh& mesh, const std::vector<VoxelMaterial>& materials, Dilatation dilatation,
                 const std::vector<float>& scale_of_voxels = {});

  // Moduli by number of the material; factors of 1.
  VoxelStiffness(const VoxelMesh& mesh, std::vector<BrickModuli<double>> moduli);

  const VoxelMesh* mesh;
  std::vector<BrickModuli<double>> moduli;  // by number of the material; that of 0 is not used
  // Of each voxel [1], then zeros: vector instructions read beyond the last. Zero for bricks with matrices of their
  // own.
  std::vector<float> scale;
};
// Factors of the solid voxels of a grid, in the order of its mesh.
std::vector<float> StiffnessOfVoxels(const VoxelGrid& grid);

// y = K x over the solid voxels of a mesh, without a matrix. S: double or float. The same bits for any number of
// threads and every instruction set. Const functions may be called by several threads at once, each with its own team.
template <class S>
class VoxelOperator {
 public:
  // The mesh and the stiffness must outlive the operator.
  explicit VoxelOperator(const VoxelStiffness& stiffness,
                         const VoxelKernels* kernels = &VoxelKernelsFor(PreferredInstructionSet()));

  // x, y: of the mesh's nodes, not the same one; y is overwritten [N, for x in m].
  void Apply(const VoxelField<S>& x, ThreadTeam& team, VoxelField<S>& y) const;
  // Its part of one slab, for loops over slabs that do more (ForSlabs).
  void ApplySlab(std::size_t slab, const VoxelField<S>& x, VoxelField<S>& y) const;

  // What kernels need for y += ... of one slab.
  ProductTask<S> TaskOf(std::size_t slab, const VoxelField<S>& x, VoxelField<S>& y) const;
  const VoxelMesh& mesh() const { return *stiffness_->mesh; }
  const VoxelKernels& kernels() const { return *kernels_; }

 private:
  const VoxelStiffness* stiffness_;
  const VoxelKernels* kernels_;
  std::vector<BrickModuli<S>> moduli_;
  BrickShape<S> shape_;
};

// The diagonal of K without bricks that have their own matrices, for every node [N/m].
VoxelField<float> DiagonalOf(const VoxelStiffness& stiffness);

}  // namespace fascicle

#endif  // FASCICLE_CORE_VOXEL_VOXEL_OPERATOR_H_
