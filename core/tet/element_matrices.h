#ifndef FASCICLE_CORE_TET_ELEMENT_MATRICES_H_
#define FASCICLE_CORE_TET_ELEMENT_MATRICES_H_

#include "core/tet/potential.h"
#include "core/tet/stiffness_layout.h"

// What a Newton system needs of the elements under IncrementalPotential: force, energy and matrix. `acting` is the
// pressure of each patch that acts on elements, W p [Pa], as VolumePatches::Smooth gives it (any size without patches).
// Models in double only. Same bits for any number of threads and every instruction set; nothing is allocated after the
// first call, but for a chunk's blocks in AssembleStiffness.
namespace fascicle {

// Of all elements, without patches, loads, inertia and floors.
struct ElementEvaluation {
  double energy = 0;          // [J]
  double smallest_ratio = 1;  // least J of all points, at most 1; NaN where one is
  double squares = 0;         // sum of the squares of all element forces [N^2]
  bool finite = true;         // all forces
};
// Sets `force` on all nodes [N]: -d/dx of the elements' energy, less that of the patches' pressures.
ElementEvaluation EvaluateElements(const TetModel& model, const IncrementalPotential& potential, const NodalVector& x,
                                   std::span<const double> acting, ThreadTeam& team, ForceWorkspace& workspace,
                                   NodalVector& force);

// Sets the matrix -df/dx of all nodes, on the pattern of the layout, from those of the elements. `projection` in [0, 1]
// is the part of every point's tangent that its projection to a positive semidefinite one replaces. The law under
// potential.untangling and the projection are computed element by element.
void AssembleStiffness(const TetModel& model, const IncrementalPotential& potential, const NodalVector& x,
                       std::span<const double> acting, double projection, const StiffnessLayout& layout,
                       ThreadTeam& team, ForceWorkspace& workspace, BlockValues& values);

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_ELEMENT_MATRICES_H_
