#ifndef FASCICLE_CORE_TET_KERNELS_H_
#define FASCICLE_CORE_TET_KERNELS_H_

#include "core/base/instruction_set.h"
#include "core/tet/element_blocks.h"

// The loops over the elements of a chunk, compiled once for each instruction set. The interface has plain numbers and
// pointers only, because nothing compiled for one set may be used by code for another.
namespace fascicle {

// One chunk with its inputs and outputs. Nodal arrays contain all nodes, three values each.
template <class S>
struct ChunkTask {
  const RestPoint<S>* points = nullptr;
  const BlockFibres<S>* fibres = nullptr;
  const std::uint16_t* local = nullptr;
  std::size_t elements = 0;
  const std::int32_t* nodes = nullptr;
  std::size_t node_count = 0;
  const std::int32_t* patch = nullptr;          // for each node of the chunk; null without patches
  const std::int32_t* element_patch = nullptr;  // of hexahedra: the first, for each slot of the chunk
  const std::int32_t* target = nullptr;         // target of each sum, see Sharing

  const void* law = nullptr;           // null: no law
  int law_kind = 0;                    // index in Material
  const double* x = nullptr;           // positions [m]
  const double* activation = nullptr;  // value of each activation curve; for laws
  // For each patch [Pa]; null: none.
  const double* pressure = nullptr;
  // Positions one step ago [m]: for laws that depend on rate, if inverse_step [1/s] is not zero, and for the change of
  // strain below.
  const double* previous = nullptr;
  double inverse_step = 0;
  // Maxwell branches add branch_factor times the passive stress of `branch_law`, a law of the same kind, and the second
  // Piola-Kirchhoff stresses `branch_stress` [Pa], kBranchTensor numbers for each point of each block. Null: none.
  const void* branch_law = nullptr;
  double branch_factor = 0;
  const double* branch_stress = nullptr;
  // Viscous stress 2 mu E + lambda tr(E) I. E is the strain rate for velocities v, or the change of strain since
  // `previous` if v is null. Both moduli zero: no viscous stress.
  double mu = 0, lambda = 0;
  const double* v = nullptr;
  // For StiffnessProduct: displacements, and the change of each patch's pressure [Pa].
  const double* p = nullptr;
  const double* pressure_change = nullptr;

  bool with_energy = false;
  double* sums = nullptr;       // for places of this chunk only; null to compute reports only
  double* slot_sums = nullptr;  // for shared places
};

struct ChunkReport {
  double smallest_ratio = 1;    // least J, at most 1; NaN if any is NaN
  double dissipated_power = 0;  // by viscous stress: integral of S:E
  double energy = 0;            // of the law, plus half of S:E, if requested [J]
  double squares = 0;           // of the elements' forces, if energy is requested [N^2]
  bool finite = true;           // whether all sums are finite
};

// Where a chunk adds up the 3x3 blocks d(-f_a)/dx_b of its elements, nine numbers each in column-major order: the block
// of nodes (a, b), a >= b, of lane k of block i goes to sums[9 * place[j * kBlock + k]] with j = pairs of an element *
// i + a (a + 1) / 2 + b, transposed if bit k of turned[j] is set. With its transpose if bit k of doubled[j] is set: if
// a and b are the same node of a collapsed element, both (a, b) and (b, a) belong to its own block.
struct ChunkBlocks {
  const std::uint16_t* place = nullptr;
  const std::uint16_t* turned = nullptr;
  const std::uint16_t* doubled = nullptr;  // null if no element is collapsed
  double* sums = nullptr;
};

template <class S>
struct ElementKernels {
  // Forces on nodes, minus the derivative of the energy; ChunkReport.
  ChunkReport (*forces)(const ChunkTask<S>&);
  // For each patch: integral of its weight times J over the chunk's elements [m^3].
  void (*corner_volumes)(const ChunkTask<S>&);
  // The change of these integrals under displacements p.
  void (*corner_volume_changes)(const ChunkTask<S>&);
  // K p with K = -df/dx and the given change of pressures, evaluated at points perturbed along the fibre.
  void (*stiffness_product)(const ChunkTask<S>&);
  // Adds the elements' blocks to the chunk's.
  void (*stiffness)(const ChunkTask<S>&, const ChunkBlocks&);
  // The second Piola-Kirchhoff stress of branch_law without activation [Pa] and the Green strain at each point of each
  // block: two tensors of kBranchTensor numbers. Null in single precision.
  void (*branch_states)(const ChunkTask<S>&, double* values);
};

// U' = k ln(theta)/theta for each of `count` patches; not finite where theta <= 0.
using PatchPressureKernel = void (*)(std::size_t count, const double* modulus, const double* theta, double* pressure);

struct Kernels {
  ElementKernels<double> linear, quadratic, hexahedral, hexahedral_quadratic;
  ElementKernels<float> linear_float, quadratic_float, hexahedral_float, hexahedral_quadratic_float;
  PatchPressureKernel patch_pressure;
};
// The set must be available on this machine.
const Kernels& KernelsFor(InstructionSet set);

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_KERNELS_H_
