#ifndef FASCICLE_CORE_VOXEL_KERNELS_H_
#define FASCICLE_CORE_VOXEL_KERNELS_H_

#include "core/base/instruction_set.h"
#include "core/geometry/voxel_mesh.h"
#include "core/voxel/brick_modes.h"

// The loops over voxels, compiled once for each instruction set. The interface has plain numbers and pointers only,
// because nothing compiled for one set may be used by code for another.
namespace fascicle {

// Bricks with matrices of their own are stored in blocks, entry by entry: 300 entries (row >= column) of this many
// bricks.
inline constexpr int kBrickBlock = 16;
inline constexpr int kPackedEntries = 300;
struct PackedBricks {
  std::int32_t node[4][kBrickBlock];  // as VoxelRun::node; unused bricks repeat another's nodes, with zero matrices
  std::int32_t bricks;                // number in use
  float entries[kPackedEntries][kBrickBlock];
};

// Some runs of voxels, and the vectors of y += K x. S: double or float.
template <class S>
struct ProductTask {
  const VoxelRun* runs;
  std::int32_t run_count;
  const float* scale;            // for each voxel, plus kPadding
  const BrickModuli<S>* moduli;  // for each material, from 1
  const BrickShape<S>* shape;
  const S* x[3];  // readable up to kPadding beyond the last node
  S* y[3];
  std::int32_t end_node;  // zeros may be added to y below this node
};

// The same for rotated bricks (rotated_bricks.h). Nine numbers of a rotation for each voxel, in column-major order,
// each followed by kPadding more.
template <class S>
struct RotatedTask : ProductTask<S> {
  const S* rotation[9];
  // In double precision only:
  const S* at[3];      // displacements at which the tangent is evaluated, laid out like x
  S* new_rotation[9];  // output: rotations at x
  S* energy;           // output: energy of each voxel [J]
};

struct PackedTask {
  const PackedBricks* blocks;
  std::int32_t block_count;
  const float* x[3];
  float* y[3];
};

// Nodes of one row, and the rows of the coarser level from which they are interpolated.
struct TransferRun {
  std::int32_t first;  // first fine node
  std::int32_t length;
  std::int32_t odd;        // 1 if the first node lies between two coarse ones
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
  void (*rotated_forces)(const RotatedTask<double>&);   // y += forces at displacements x; sets rotations and energies
  void (*rotated_tangent)(const RotatedTask<double>&);  // y += (their derivative at `at`) x
  void (*rotated_product)(const RotatedTask<float>&);   // y += R K R^T x
  void (*packed)(const PackedTask&);
  void (*interpolate)(const TransferTask&);             // to += P from, from coarse to fine
  void (*interpolate_transposed)(const TransferTask&);  // to += P^T from, from fine to coarse
};

// The set must be available on this machine.
const VoxelKernels& VoxelKernelsFor(InstructionSet set);

}  // namespace fascicle

#endif  // FASCICLE_CORE_VOXEL_KERNELS_H_
