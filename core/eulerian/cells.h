#ifndef FASCICLE_CORE_EULERIAN_CELLS_H_
#define FASCICLE_CORE_EULERIAN_CELLS_H_

#include <vector>

#include "core/eulerian/body.h"
#include "core/eulerian/state.h"

namespace fascicle {

// Quantities of each cell that follow from the reference map; scratch memory of steps and frames.
struct EulerianCells {
  std::vector<double> inside;      // solid part; 0 if it is a sliver [1]
  std::vector<Mat3> F;             // deformation gradient (dX/dx)^-1 at the centre, for solid cells
  std::vector<double> J;           // det F
  std::vector<double> distance;    // phi0(X) for each node [m]; large where X is not known
  std::vector<std::size_t> solid;  // cells that are solid in part, ascending
  double smallest_J = 1, largest_J = 1;
  bool valid = true;  // whether F is finite and J > 0 in all solid cells
};

// [Fan 2013, 3.1].
void UpdateCells(const EulerianBody& body, const EulerianState& state, ThreadTeam& team, EulerianCells& cells);

// Volume of the solid, summed over its cells [m^3]. The volume within the surface (surface.h) is more accurate.
double SolidVolume(const EulerianBody& body, const EulerianCells& cells);

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_CELLS_H_
