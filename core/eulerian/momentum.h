#ifndef FASCICLE_CORE_EULERIAN_MOMENTUM_H_
#define FASCICLE_CORE_EULERIAN_MOMENTUM_H_

#include "core/eulerian/forces.h"

namespace fascicle {

// Sum over the nodes of a quantity and of its moment about the origin: of momenta [kg m/s, kg m^2/s], or of forces [N,
// N m].
struct Resultant {
  Vec3 sum = Vec3::Zero(), moment = Vec3::Zero();
};
double MassOf(const NodalForces& nodes, ThreadTeam& team);  // [kg]
Resultant MomentumOf(const EulerianGrid& grid, const NodalForces& nodes, const std::vector<Vec3>& v, ThreadTeam& team);
Resultant ForceOf(const EulerianGrid& grid, const NodalForces& nodes, ThreadTeam& team);

// The velocity of a rigid body at its points.
struct RigidVelocity {
  Vec3 centre = Vec3::Zero();                       // of mass [m]
  Vec3 linear = Vec3::Zero(), spin = Vec3::Zero();  // of the centre [m/s], and angular [rad/s]

  Vec3 At(const Vec3& x) const { return linear + spin.cross(x - centre); }
};

// With the masses of the nodes: the one that has a momentum, and the one that has the momentum of the velocities v,
// which is nearest to them by mass.
RigidVelocity RigidVelocityOf(const EulerianGrid& grid, const NodalForces& nodes, const Resultant& momentum,
                              ThreadTeam& team);
RigidVelocity RigidPartOf(const EulerianGrid& grid, const NodalForces& nodes, const std::vector<Vec3>& v,
                          ThreadTeam& team);

// Adds a rigid-body velocity to all known nodes such that momentum and its moment are as wanted. Otherwise advection,
// and mass that moves between nodes, would add spurious momentum and angular momentum.
void SetMomentum(const EulerianGrid& grid, const NodalForces& nodes, const Resultant& wanted,
                 const std::vector<std::uint8_t>& known, ThreadTeam& team, std::vector<Vec3>& v);

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_MOMENTUM_H_
