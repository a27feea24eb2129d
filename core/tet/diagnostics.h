#ifndef FASCICLE_CORE_TET_DIAGNOSTICS_H_
#define FASCICLE_CORE_TET_DIAGNOSTICS_H_

#include <vector>

#include "core/scene/support_moment.h"
#include "core/tet/controls.h"
#include "core/tet/forces.h"
#include "core/tet/state.h"

// Measurements of a state, once per frame.
namespace fascicle {

// Sum of m v^2 / 2 over all nodes [J].
double KineticEnergy(const TetModel& model, const NodalVector& v, ThreadTeam& team);

struct VolumeRatios {
  double total = 1;     // current over rest volume of the body
  double smallest = 1;  // least J of its elements
};
VolumeRatios VolumeRatiosOf(const TetModel& model, std::size_t body, const NodalVector& x);

// Force of supports on each node [N]: m a - (elastic + viscous + mass damping + external force, floors included) over
// the components that a support prescribes, where a is the prescribed acceleration; zero elsewhere. In quasi-static
// stepping there is neither inertia nor damping.
//   now    the controls at the state's time
//   later  those after another step as long as the last one: a is the difference of their velocities over that step
NodalVector ReactionForces(const TetModel& model, const TetState& state, const Controls& now, const Controls& later,
                           ThreadTeam& team);

// The resultants of these forces for each support. A component prescribed by two supports counts for the first.
std::vector<Reaction> Reactions(const TetModel& model, const TetState& state, const Controls& now,
                                const Controls& later, ThreadTeam& team);

// Largest speed of a node [m/s].
double LargestSpeed(const NodalVector& v);

// Largest sum of elastic, viscous and external forces on a free component, relative to the largest of these forces on
// any node: 0 in equilibrium at rest [1].
double EquilibriumResidual(const TetModel& model, const TetState& state, const Controls& now, ThreadTeam& team);

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_DIAGNOSTICS_H_
