#ifndef FASCICLE_CORE_VOXEL_KERNELS_H_
#define FASCICLE_CORE_VOXEL_KERNELS_H_

#include "core/base/instruction_set.h"
#include "core/geometry/voxel_mesh.h"
#include "core/voxel/brick_modes.h"

// The loops over voxels, compiled for each instruction set. Plain numbers and pointers: whatever is compiled for one
// set must not be of use to code for another.
namespace fascicle {

// Bricks with matrices of their own come in blocks, entry by entry: 300 entries (row >= column) of that many bricks.
inline constexpr int kBrickBlock = 16;
inline constexpr int kPackedEntries = 300;
struct PackedBricks {
  std::int32_t node[4][kBrickBlock];  // as VoxelRun::node; unused bricks repeat another's nodes and have zero matrices
  std::int32_t bricks;                // in use
  float entries[kPackedEntries][kBrickBlock];
};

// Some runs of voxels, and the vectors of y += K x. S: double or float.
template <class S>
struct ProductTask {
  const VoxelRun* runs;
  std::int32_t run_count;
  const float* scale;            // of each voxel, kPadding beyond the last
  const BrickModuli<S>* moduli;  // of each material, from 1
  const BrickShape<S>* shape;
  const S* x[3];  // readable kPadding beyond the last node
  S* y[3];
  std::int32_t end_node;  // zeros may be added to y before that
};

// The same for bricks that have turned (rotated_bricks.h). Nine numbers of a rotation for each voxel, column by column,
// kPadding of each beyond the last.
template <class S>
struct RotatedTask : ProductTask<S> {
  const S* rotation[9];
  // Of double precision alone:
  const S* at[3];      // displacements of which the tangent is taken, as x
  S* new_rotation[9];  // where rotations of x are to be written to
  S* energy;           // of each voxel [J], to be written to
};

struct PackedTask {
  const PackedBricks* blocks;
  std::int32_t block_count;
  const float* x[3];
  float* y[3];
};

// Nodes of one row, and the rows of twice the spacing that they are interpolated from.
struct TransferRun {
  std::int32_t first;  // fine node
  std::int32_t length;
  std::int32_t odd;        // 1 where the first node is between two coarse ones
  std::int32_t rows;       // 1, 2 or 4
  std::int32_t coarse[4];  // first coarse node of each row
};

struct TransferTask {
  const TransferRun* runs;
  std::int32_t run_count;
  const float* from[3];
  float* to[3];
};

struct VoxelKernels {
  void (*product)(const ProductTask<double>&);
  void (*product_float)(const ProductTask<float>&);
  void (*rotated_forces)(const RotatedTask<double>&);   // y += forces at displacements x, with rotations and energies
  void (*rotated_tangent)(const RotatedTask<double>&);  // y += (their derivative at `at`) x
  void (*rotated_product)(const RotatedTask<float>&);   // y += R K R^T x
  void (*packed)(const PackedTask&);
  void (*interpolate)(const TransferTask&);             // to += P from, from coarse to fine
  void (*interpolate_transposed)(const TransferTask&);  // to += P^T from, from fine to coarse
};

// The set must be available.
const VoxelKernels& VoxelKernelsFor(InstructionSet set);

}  // namespace fascicle

#endif  // FASCICLE_CORE_VOXEL_KERNELS_H_
