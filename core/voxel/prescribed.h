#ifndef FASCICLE_CORE_VOXEL_PRESCRIBED_H_
#define FASCICLE_CORE_VOXEL_PRESCRIBED_H_

#include <vector>

#include "core/voxel/galerkin.h"
#include "core/voxel/model.h"

namespace fascicle {

// The set of a mesh's components that supports prescribe (not their values).
class PrescribedComponents {
 public:
  PrescribedComponents(const VoxelMesh& mesh, const std::vector<VoxelSupport>& supports);

  const FixedComponents& of_nodes() const { return of_nodes_; }
  // Their indices in fields of the mesh, ascending.
  const std::vector<std::size_t>& numbers() const { return numbers_; }

  void Clear(VoxelField<double>& field) const {
    for (const std::size_t k : numbers_) field.data()[k] = 0;
  }
  void Copy(const VoxelField<double>& from, VoxelField<double>& to) const {
    for (const std::size_t k : numbers_) to.data()[k] = from.data()[k];
  }

 private:
  FixedComponents of_nodes_;
  std::vector<std::size_t> numbers_;
};

// The displacements prescribed by supports; zero elsewhere [m].
VoxelField<double> DisplacementsOf(const VoxelMesh& mesh, const std::vector<VoxelSupport>& supports);

}  // namespace fascicle

#endif  // FASCICLE_CORE_VOXEL_PRESCRIBED_H_
