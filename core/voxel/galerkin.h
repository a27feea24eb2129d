#ifndef FASCICLE_CORE_VOXEL_GALERKIN_H_
#define FASCICLE_CORE_VOXEL_GALERKIN_H_

#include <cstdint>
#include <optional>
#include <vector>

#include "core/voxel/rotated_bricks.h"
#include "core/voxel/slabs.h"
#include "core/voxel/voxel_operator.h"

namespace fascicle {

// Bits 1, 2, 4 for each node: components 0, 1, 2 are prescribed. Empty: none.
using FixedComponents = std::vector<std::uint8_t>;

// Stiffness of one multigrid level: P^T K P of the finer level, brick by brick.
//
// Where eight voxels have the same stiffness and no prescribed component, the result is the stiffness of a brick with
// twice the spacing, because the trilinear functions of a level are contained in those of the finer one. Other bricks
// (at boundaries, between materials, at supports, and all rotated ones) have matrices of their own.
class LevelStiffness {
 public:
  // The finest level; for rotated bricks R K R^T of each.
  LevelStiffness(const VoxelMesh& mesh, VoxelStiffness stiffness,
                 std::optional<BrickRotations<float>> rotations = std::nullopt);
  // `fine` is needed during construction only; `fixed` refers to its nodes. mesh: CoarserMesh of fine.
  static VoxelMesh CoarserMesh(const VoxelMesh& fine);
  LevelStiffness(const VoxelMesh& mesh, const LevelStiffness& fine, const FixedComponents& fixed, ThreadTeam& team);
  LevelStiffness(const LevelStiffness&) = delete;
  LevelStiffness& operator=(const LevelStiffness&) = delete;

  const VoxelMesh& mesh() const { return *mesh_; }
  const VoxelStiffness& stiffness() const { return stiffness_; }
  std::size_t own_matrices() const { return own_count_; }
  std::size_t bytes() const;

  // y = K x.
  void Apply(const VoxelField<float>& x, ThreadTeam& team, VoxelField<float>& y) const;
  VoxelField<float> Diagonal() const;
  // K of one voxel [N/m], a voxel of mesh() in a run of that material.
  BrickMatrix MatrixOf(std::int32_t voxel, std::int32_t material) const;

 private:
  VoxelField<float> RotatedDiagonal() const;
  void FindOwn(const LevelStiffness& fine, const FixedComponents& fixed);
  void FillOwn(const LevelStiffness& fine, const FixedComponents& fixed, ThreadTeam& team);

  const VoxelMesh* mesh_;
  VoxelStiffness stiffness_;
  std::optional<BrickRotations<float>> rotations_;
  VoxelOperator<float> operator_;
  std::vector<BrickMatrix> of_material_;
  const VoxelKernels* kernels_ = &VoxelKernelsFor(PreferredInstructionSet());
  std::size_t own_count_ = 0;
  std::vector<std::int32_t> own_;  // for each voxel: kBrickBlock * block + lane, or -1; empty: none
  std::vector<PackedBricks> blocks_;
  std::vector<std::int32_t> slab_begin_;  // first block of each slab, and the end
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_VOXEL_GALERKIN_H_
