#ifndef FASCICLE_CORE_EULERIAN_FORCES_H_
#define FASCICLE_CORE_EULERIAN_FORCES_H_

#include <vector>

#include "core/eulerian/cells.h"
#include "core/eulerian/extrapolation.h"

namespace fascicle {

// Lumped mass [kg] and forces [N] of the nodes inside of the solid; zero elsewhere. Nodes outside that solid cells have
// as corners follow those inside by ExtrapolationWeights; their masses and forces are theirs, each by its weight, so
// that slivers of cells neither move by themselves nor fray the surface, and momentum is kept [Badia, Verdugo & Martin
// 2018, the aggregated unfitted finite element method].
struct NodalForces {
  std::vector<double> mass;
  std::vector<Vec3> force;
  std::vector<std::uint8_t> inside;              // of each node: 1 where it is inside and has mass
  std::vector<std::uint8_t> held;                // of each node: 1 where it is held, inside or not
  std::vector<std::vector<NodeWeight>> leaders;  // of each node: whom it follows, if it does
};

// m = sum of rho0/J times an eighth of the solid part of each cell around a node; f = sum of -V sigma grad N, with
// sigma = P F^T / J and V the solid part, of gravity, of the given force, and of damping [Fan 2013, 3.1].
void SetForces(const EulerianBody& body, const EulerianState& state, const EulerianCells& cells, ThreadTeam& team,
               NodalForces& nodes);

// Elastic energy of the solid [J].
double ElasticEnergy(const EulerianBody& body, const EulerianState& state, const EulerianCells& cells);
double KineticEnergy(const EulerianState& state, const NodalForces& nodes);  // [J]
Vec3 Momentum(const EulerianState& state, const NodalForces& nodes);         // [kg m/s]

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_FORCES_H_
