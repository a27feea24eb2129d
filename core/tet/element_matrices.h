#ifndef FASCICLE_CORE_TET_ELEMENT_MATRICES_H_
#define FASCICLE_CORE_TET_ELEMENT_MATRICES_H_

#include "core/tet/potential.h"
#include "core/tet/stiffness_layout.h"

// Force, energy and stiffness matrix of the elements under an IncrementalPotential, for Newton's method. `acting` is
// the pressure of each patch as it acts on elements, W p [Pa], from VolumePatches::Smooth (any size without patches).
// For models in double only. The same bits for any number of threads and every instruction set. Allocates nothing after
// the first call, except for a chunk's blocks in AssembleStiffness.
namespace fascicle {

// Results for all elements, without patches, loads, inertia and floors.
struct ElementEvaluation {
  double energy = 0;          // [J]
  double smallest_ratio = 1;  // least J of all points, at most 1; NaN if any is NaN
  double squares = 0;         // sum of squares of all element forces [N^2]
  bool finite = true;         // whether all forces are finite
};
// Sets `force` of all nodes [N]: minus the derivative of the elements' energy by x, including the pressures of patches.
ElementEvaluation EvaluateElements(const TetModel& model, const IncrementalPotential& potential, const NodalVector& x,
                                   std::span<const double> acting, ThreadTeam& team, ForceWorkspace& workspace,
                                   NodalVector& force);

// Sets the matrix -df/dx of all nodes, on the pattern of the layout, by assembly of the element matrices. The
// untangling law is evaluated element by element.
void AssembleStiffness(const TetModel& model, const IncrementalPotential& potential, const NodalVector& x,
                       std::span<const double> acting, const StiffnessLayout& layout, ThreadTeam& team,
                       ForceWorkspace& workspace, BlockValues& values);

// Sets the change of that matrix when the tangent of every point is replaced by the nearest positive semidefinite one.
// Elements whose tangents are so already add nothing.
void AssembleProjection(const TetModel& model, const IncrementalPotential& potential, const NodalVector& x,
                        std::span<const double> acting, const StiffnessLayout& layout, ThreadTeam& team,
                        ForceWorkspace& workspace, BlockValues& values);

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_ELEMENT_MATRICES_H_
