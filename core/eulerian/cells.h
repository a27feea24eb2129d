#ifndef FASCICLE_CORE_EULERIAN_CELLS_H_
#define FASCICLE_CORE_EULERIAN_CELLS_H_

#include <vector>

#include "core/eulerian/body.h"
#include "core/eulerian/state.h"

namespace fascicle {

// What follows from the reference map for each cell: scratch of a step, and of its frames.
struct EulerianCells {
  std::vector<double> inside;      // part of it that is solid; 0 where that is less than a sliver [1]
  std::vector<Mat3> F;             // deformation gradient (dX/dx)^-1 at the centre; of solid cells
  std::vector<double> J;           // det F
  std::vector<double> distance;    // phi0(X) of each node [m]; large where X is not known
  std::vector<std::size_t> solid;  // numbers of the cells that are solid in part, ascending
  double smallest_J = 1, largest_J = 1;
  bool valid = true;  // whether F is finite and J > 0 in all of them
};

// [Fan 2013, 3.1].
void UpdateCells(const EulerianBody& body, const EulerianState& state, ThreadTeam& team, EulerianCells& cells);

// Volume of the solid by its cells [m^3]. What is measured on the surface (surface.h) is more exact.
double SolidVolume(const EulerianBody& body, const EulerianCells& cells);

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_CELLS_H_
