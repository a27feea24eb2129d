#ifndef FASCICLE_CORE_EULERIAN_PROJECTION_H_
#define FASCICLE_CORE_EULERIAN_PROJECTION_H_

#include "core/eulerian/forces.h"
#include "core/linalg/active_set_qp.h"

namespace fascicle {

struct StepLength {
  double dt = 0;      // [s]
  double stable = 0;  // what it would be if no frame ended it [s]
  double waves = 0;   // what the fastest wave would allow [s]
};

struct Projection {
  QpReport report;
  std::vector<Vec3> held_impulses;  // of nodes, if any are held: what volumes and implicit elasticity
                                    // push held ones with [N s]
};

// v = argmin 1/2 (v - v*) . M (v - v*), with M + dt^2 K for the first M where elasticity is implicit, where the volume
// of solid cells changes as body.volume says and held nodes move as they are made to [Fan 2013, 3.2, 3.11]:
//   sum over nodes of V grad N . v + eps L p = V (1 - J)/(dt J), or 0,
// summed over the cells of a block: cells of little solid have no pressure of their own.
//   velocity  v* of nodes inside, given velocities of held ones; the result. Others are not read.
//   pressure  of each cell: set in those that have one, in the mean of the step, compression positive [Pa]
Projection ProjectVelocity(const EulerianBody& body, const EulerianState& state, const EulerianCells& cells,
                           const NodalForces& nodes, const StepLength& step, ThreadTeam& team,
                           std::vector<Vec3>& velocity, std::vector<double>& pressure);

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_PROJECTION_H_
