#ifndef FASCICLE_CORE_TET_ELEMENT_MATRICES_H_
#define FASCICLE_CORE_TET_ELEMENT_MATRICES_H_

#include <functional>

#include "core/tet/potential.h"

// What a Newton system needs of the elements under IncrementalPotential: the force and energy, and the matrices of
// each. `acting` is the pressure of each patch that acts on elements, W p [Pa], as VolumePatches::Smooth gives it (any
// size without patches). Models in double only. Same bits for any number of threads and every instruction set; nothing
// is allocated after the first call, but for threads above one in AddStiffness.
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

// Matrices of elements [begin, begin + count), one after another.
struct ElementMatrices {
  std::size_t begin = 0, count = 0;
  int nodes = 0;  // of an element

  int pairs() const { return nodes * (nodes + 1) / 2; }
  // d(-f_a)/dx_b of nodes a >= b of element begin + k, nine numbers column by column [N/m].
  const double* Block(std::size_t k, int a, int b) const { return blocks + 9 * (k * pairs() + a * (a + 1) / 2 + b); }
  // Derivative of the integral of L_c J by x_b [m^2].
  const double* VolumeChange(std::size_t k, int c, int b) const { return volumes + 3 * ((4 * k + c) * nodes + b); }

  const double* blocks = nullptr;
  const double* volumes = nullptr;
};
// Calls visit with the matrices of all elements, some at a time, from several threads at once; they are there until it
// returns. `projection` in [0, 1] is the part of every point's tangent that its projection to a positive semidefinite
// one replaces. The law under potential.untangling and the projection are computed element by element.
void ForElementMatrices(const TetModel& model, const IncrementalPotential& potential, const NodalVector& x,
                        std::span<const double> acting, double projection, ThreadTeam& team,
                        const ForceWorkspace& workspace, const std::function<void(const ElementMatrices&)>& visit);

// Where a block is not wanted.
inline constexpr std::int32_t kNoBlock = INT32_MAX;

// Adds all blocks to a matrix of 3x3 blocks, each nine numbers column by column: that of pair k of element e to
// values[9 place ..] with place = places[pairs * e + k], transposed where place is negative, to block ~place; not at
// all for kNoBlock. Blocks are added in the order of the elements.
void AddStiffness(const TetModel& model, const IncrementalPotential& potential, const NodalVector& x,
                  std::span<const double> acting, double projection, std::span<const std::int32_t> places,
                  ThreadTeam& team, ForceWorkspace& workspace, std::span<double> values);

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_ELEMENT_MATRICES_H_
