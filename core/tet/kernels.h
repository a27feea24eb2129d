#ifndef FASCICLE_CORE_TET_KERNELS_H_
#define FASCICLE_CORE_TET_KERNELS_H_

#include "core/base/instruction_set.h"
#include "core/tet/element_blocks.h"

// The loops over the elements of a chunk, compiled for each instruction set. Plain numbers and pointers: whatever is
// compiled for one set must not be of use to code for another.
namespace fascicle {

// One chunk and what acts on it. Nodal values are of all nodes, three a node.
template <class S>
struct ChunkTask {
  const RestPoint<S>* points = nullptr;
  const BlockFibres<S>* fibres = nullptr;
  const std::uint16_t* local = nullptr;
  std::size_t elements = 0;
  const std::int32_t* nodes = nullptr;
  std::size_t node_count = 0;
  const std::int32_t* patch = nullptr;   // of each node of the chunk; null without patches
  const std::int32_t* target = nullptr;  // of each sum, see Sharing

  const void* law = nullptr;           // null for none
  int law_kind = 0;                    // index in Material
  const double* x = nullptr;           // positions [m]
  const double* activation = nullptr;  // of each curve; with a law
  // Of each patch [Pa]; null for none.
  const double* pressure = nullptr;
  // Positions a step ago [m], for laws that depend on rate where inverse_step [1/s] is not zero, and for the strain
  // change below.
  const double* previous = nullptr;
  double inverse_step = 0;
  // Viscous stress 2 mu E + lambda tr(E) I: of the strain rate E under velocities v, or of the change of strain since
  // `previous` where v is null. None where both moduli are zero.
  double mu = 0, lambda = 0;
  const double* v = nullptr;
  // For StiffnessProduct: displacements, and the change of each patch's pressure [Pa].
  const double* p = nullptr;
  const double* pressure_change = nullptr;

  bool with_energy = false;
  double* sums = nullptr;       // where no other chunk has part; null for reports alone
  double* slot_sums = nullptr;  // of shared places
};

struct ChunkReport {
  double smallest_ratio = 1;    // least J, at most 1; NaN where one is
  double dissipated_power = 0;  // by viscous stress: integral of S:E
  double energy = 0;            // of the law and half of S:E, where asked for [J]
  double squares = 0;           // of the elements' forces, where energy is asked for [N^2]
  bool finite = true;           // all sums
};

// Where a chunk adds up the 3x3 blocks d(-f_a)/dx_b of its elements, nine numbers each, column by column: that of pair
// (a, b) of nodes, a >= b, of lane k of block i to sums[9 * place[j * kBlock + k]] with j = pairs of an element * i +
// a (a + 1) / 2 + b, transposed where bit k of turned[j] is set.
struct ChunkBlocks {
  const std::uint16_t* place = nullptr;
  const std::uint16_t* turned = nullptr;
  double* sums = nullptr;
};

template <class S>
struct ElementKernels {
  // Forces on nodes, minus the derivative of the energy; ChunkReport.
  ChunkReport (*forces)(const ChunkTask<S>&);
  // For each patch, integral of L_c J over the chunk's elements [m^3].
  void (*corner_volumes)(const ChunkTask<S>&);
  // Their change with displacements p.
  void (*corner_volume_changes)(const ChunkTask<S>&);
  // K p, K = -df/dx with the pressures' change as given, at points a hair longer along the fibre.
  void (*stiffness_product)(const ChunkTask<S>&);
  // Adds the elements' blocks to the chunk's.
  void (*stiffness)(const ChunkTask<S>&, const ChunkBlocks&);
};

// U' = k ln(theta)/theta of each of `count` patches; not finite where theta <= 0.
using PatchPressureKernel = void (*)(std::size_t count, const double* modulus, const double* theta, double* pressure);

struct Kernels {
  ElementKernels<double> linear, quadratic;
  ElementKernels<float> linear_float, quadratic_float;
  PatchPressureKernel patch_pressure;
};
// The set must be available.
const Kernels& KernelsFor(InstructionSet set);

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_KERNELS_H_
