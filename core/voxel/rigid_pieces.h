#ifndef FASCICLE_CORE_VOXEL_RIGID_PIECES_H_
#define FASCICLE_CORE_VOXEL_RIGID_PIECES_H_

#include <cstdint>
#include <vector>

#include "core/linalg/aggregation.h"
#include "core/voxel/factored_blocks.h"

namespace fascicle {

// A coarse space for a level that larger bricks represent badly: pieces of about 3x3x3 nodes that move as rigid bodies,
// smoothed [Vanek, Mandel & Brezina 1996; core/linalg/aggregation.h]. It represents the bending of thin parts, whatever
// fraction of a larger brick they fill. Its matrix P^T (K + D) P is factored. Not thread-safe.
class RigidPieces {
 public:
  // shift: D, or empty; inverse_diagonal: of K + D, zero for components to exclude; largest_eigenvalue: of the matrix
  // preconditioned by it.
  RigidPieces(const LevelStiffness& K, const VoxelField<float>& shift, const VoxelField<float>& inverse_diagonal,
              float largest_eigenvalue, ThreadTeam& team);

  bool ok() const { return ok_; }
  // x = P (P^T (K + D) P)^-1 P^T r.
  void Correct(const VoxelField<float>& r, ThreadTeam& team, VoxelField<float>& x);

  std::size_t unknowns() const { return factors_.unknowns(); }
  std::size_t bytes() const;

 private:
  BlockPattern rows_;  // of P
  TransposedPattern columns_;
  std::vector<Eigen::Matrix3f> values_;
  FactoredBlocks factors_;
  bool ok_ = false;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_VOXEL_RIGID_PIECES_H_
