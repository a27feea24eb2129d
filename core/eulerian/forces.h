#ifndef FASCICLE_CORE_EULERIAN_FORCES_H_
#define FASCICLE_CORE_EULERIAN_FORCES_H_

#include <vector>

#include "core/eulerian/node_roles.h"

namespace fascicle {

// Lumped masses [kg] and forces [N] of free and prescribed nodes; zero elsewhere. Those of constrained nodes are added
// to their root nodes by their weights, which conserves momentum and forces.
struct NodalForces {
  std::vector<double> mass;
  std::vector<double> own_mass;  // before masses of constrained nodes are added [kg]
  std::vector<Vec3> force;
};

// m = sum of rho0/J times an eighth of the solid part of each cell around a node; f = sum of -V sigma grad N, with
// sigma = P F^T / J of the elastic F and V the solid part, plus gravity, loads, force fields and damping [Fan 2013,
// 3.2]. Sets roles too.
void SetForces(const EulerianBody& body, const EulerianState& state, const BodyControls& controls,
               const EulerianCells& cells, ThreadTeam& team, NodeRoles& roles, NodalForces& nodes);

double KineticEnergy(const EulerianState& state, const NodalForces& nodes);  // [J]

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_FORCES_H_
