#ifndef FASCICLE_CORE_LINALG_AGGREGATION_H_
#define FASCICLE_CORE_LINALG_AGGREGATION_H_

#include "core/linalg/block_matrix.h"

namespace fascicle {

// Interpolation from a coarser level: one row of the pattern for each block of the finer level.
struct Prolongation {
  BlockPattern pattern;
  BlockValues values;
  std::size_t coarse = 0;    // number of blocks of the coarser level
  bool is_diagonal = false;  // whether all blocks are diagonal matrices
};

// Meaning of the three components of a block: the translation of a point, or a rotation about it.
struct RigidBlock {
  Vec3 position = Vec3::Zero();  // [m]
  double rotation_scale = 0;     // length by which rotations are measured [m]; 0 for a translation
};

// Interpolation by smoothed aggregation with rigid body modes [Vanek, Mandel & Brezina 1996, Algebraic multigrid by
// smoothed aggregation for second and fourth order elliptic problems, Computing 56]: strongly coupled blocks are joined
// to aggregates. Each aggregate moves as a rigid body, with a translation and a rotation (two blocks of the coarser
// level, in this order). One step of damped Jacobi smooths the interpolation.
//   blocks           meaning of the finer level's blocks; on a level made of aggregates the two blocks of an aggregate
//                    are consecutive
//   inverse_diagonal of the values; largest_eigenvalue: an upper bound for inverse_diagonal times the matrix
//   coarse_blocks    receives the meaning of the coarser level's blocks
Prolongation SmoothedAggregation(const BlockPattern& pattern, const BlockValues& values, const FreeComponents& free,
                                 const std::vector<RigidBlock>& blocks, const BlockValues& inverse_diagonal,
                                 double largest_eigenvalue, std::vector<RigidBlock>& coarse_blocks);

// Galerkin product P^T A P: the pattern is found once, the values whenever those of A change.
class GalerkinProduct {
 public:
  GalerkinProduct() = default;
  GalerkinProduct(const BlockPattern& fine, const Prolongation& prolongation);

  const BlockPattern& pattern() const { return coarse_; }
  void Compute(const BlockPattern& fine, const BlockValues& values, const Prolongation& prolongation, ThreadTeam& team,
               BlockValues& coarse_values);
  const TransposedPattern& restriction() const { return restriction_; }

 private:
  template <class Add>
  static void Multiply(const BlockPattern& left, const BlockPattern& right, const BlockPattern& product,
                       ThreadTeam& team, BlockValues& values, const Add& add);

  BlockPattern product_, coarse_;  // of A P, of P^T A P
  TransposedPattern restriction_;
  BlockValues product_values_;  // scratch
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_LINALG_AGGREGATION_H_
