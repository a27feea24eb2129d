#ifndef FASCICLE_CORE_VOXEL_FACTORED_BLOCKS_H_
#define FASCICLE_CORE_VOXEL_FACTORED_BLOCKS_H_

#include <span>
#include <vector>

#include "core/linalg/block_matrix.h"
#include "core/linalg/direct_solver.h"
#include "core/voxel/galerkin.h"

namespace fascicle {

// A matrix of 3x3 blocks with its sparsity pattern.
struct BlockMatrix {
  BlockPattern pattern;
  BlockValues values;
};

// K + D of a level as blocks, one for each pair of nodes with a common voxel. shift: D, or empty.
BlockMatrix AssembleLevel(const LevelStiffness& K, const VoxelField<float>& shift);

// A factorization of a positive semidefinite matrix of 3x3 blocks. Zero-energy motions are regularized by a small
// multiple of the diagonal; components with a zero diagonal are isolated. Not thread-safe.
class FactoredBlocks {
 public:
  // Reads the lower triangle. False when memory runs out.
  bool Factor(const BlockPattern& pattern, const BlockValues& values);

  // Three numbers for each block: the right-hand side; after Solve() the solution.
  std::span<double> side() { return side_; }
  void Solve() { solver_.Solve(side_); }
  std::size_t unknowns() const { return side_.size(); }

 private:
  DirectSolver solver_;
  std::vector<double> side_;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_VOXEL_FACTORED_BLOCKS_H_
