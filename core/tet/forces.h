#ifndef FASCICLE_CORE_TET_FORCES_H_
#define FASCICLE_CORE_TET_FORCES_H_

#include <span>
#include <vector>

#include "core/tet/element.h"
#include "core/tet/model.h"

// Loops over the elements: the law is fixed once for each body and call, nothing is allocated, and results are the same
// bits for any number of threads, because every element writes its own corner forces and every node adds up its corners
// in a fixed order.
//   activation  of each body [1]
//   x, v        positions [m] and velocities [m/s] of all nodes
//   corners     scratch, 4 forces for each element
namespace fascicle {

// One force for each corner of each element, before they are added up.
using CornerForceArray = std::vector<CornerForces>;

struct ForceReport {
  bool valid = true;            // false where an element has J <= 0 or a stress that is not finite
  double dissipated_power = 0;  // by viscous stress [W]
  double smallest_ratio = 1;    // least J of all elements, at most 1
};

// Elastic (and active) force of all elements on the nodes [N] [Teran 2003, 4.1].
ForceReport ElasticForce(const TetModel& model, std::span<const double> activation, const NodalVector& x,
                         ThreadTeam& team, CornerForceArray& corners, NodalVector& force);

// The same with the viscous force added, in one loop.
ForceReport ElasticAndViscousForce(const TetModel& model, std::span<const double> activation, const NodalVector& x,
                                   const NodalVector& v, ThreadTeam& team, CornerForceArray& corners,
                                   NodalVector& force);

// The viscous force D v alone: linear in v, symmetric, negative semidefinite.
void ViscousForce(const TetModel& model, const NodalVector& x, const NodalVector& v, ThreadTeam& team,
                  CornerForceArray& corners, NodalVector& force);

// The diagonal of -D [kg/s], not negative.
void ViscousDiagonal(const TetModel& model, const NodalVector& x, ThreadTeam& team, CornerForceArray& corners,
                     NodalVector& diagonal);

// Elastic energy of one body [J].
double ElasticEnergy(const TetModel& model, std::size_t body, double activation, const NodalVector& x,
                     ThreadTeam& team);

// Adds up the corners of every node; `sums` gets its size.
void GatherCorners(const TetModel& model, const CornerForceArray& corners, ThreadTeam& team, NodalVector& sums);

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_FORCES_H_
