#ifndef FASCICLE_CORE_TET_DIAGNOSTICS_H_
#define FASCICLE_CORE_TET_DIAGNOSTICS_H_

#include <vector>

#include "core/tet/controls.h"
#include "core/tet/forces.h"
#include "core/tet/state.h"

// What is measured of a state, once a frame.
namespace fascicle {

// Sum of m v^2 / 2 over all nodes [J].
double KineticEnergy(const TetModel& model, const NodalVector& v, ThreadTeam& team);

struct VolumeRatios {
  double total = 1;     // present over rest volume of the body
  double smallest = 1;  // least J of its elements
};
VolumeRatios VolumeRatiosOf(const TetModel& model, std::size_t body, const NodalVector& x);

// Force of each support on its body [N]: m a - (elastic + viscous + mass damping + external force, floors' among it)
// over the components that the support prescribes, a the prescribed acceleration. Where two supports share a component,
// it counts for the first.
std::vector<Vec3> Reactions(const TetModel& model, const TetState& state, ThreadTeam& team);

// Largest speed of a node [m/s].
double LargestSpeed(const NodalVector& v);

// Elastic, viscous and external forces on the free components, their largest size over that of the largest single
// force of the three on any node: 0 in equilibrium at rest [1].
double EquilibriumResidual(const TetModel& model, const TetState& state, ThreadTeam& team);

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_DIAGNOSTICS_H_
