#ifndef FASCICLE_CORE_TET_FLOOR_CONTACT_H_
#define FASCICLE_CORE_TET_FLOOR_CONTACT_H_

#include <vector>

#include "core/tet/model.h"

// Floors: penalty forces on surface nodes below a plane,
//   f = k_n d n,   energy k_n d^2 / 2,   d = -(x - point).n where positive,
// with the floor's normal n and the stiffness k_n of TetModel::contact_nodes(). Without friction, so energy is
// conserved.
//
// Over a step from `start` to x, the mean of the forces at its ends does not do the work of the energy where a node
// meets or leaves the floor. With `start`, the functions of a Newton iteration have instead the force f' whose mean
// with that at the start does: (f + f')/2 = (energy' - energy) / (d' - d). It has a potential, too, convex and smooth.
namespace fascicle {

// Adds the force of all floors to every node [N].
void AddFloorForce(const TetModel& model, const NodalVector& x, NodalVector& force, const NodalVector* start = nullptr);

// Force of each floor on all bodies [N].
std::vector<Vec3> FloorForces(const TetModel& model, const NodalVector& x);

// Energy stored in all contacts, or the potential of f' [J].
double FloorEnergy(const TetModel& model, const NodalVector& x, const NodalVector* start = nullptr);

// Energy [J], force [N] and stiffness [N/m] of a contact of stiffness k at depth d [m], or those of f' with the depth
// at the start.
struct FloorResponse {
  double energy = 0, force = 0, stiffness = 0;
};
FloorResponse ResponseAt(double k, double d);
FloorResponse ResponseAt(double k, double d, double start);

// Calls visit(node, stiffness) for every node whose force depends on x, with the 3x3 derivative of minus the force
// [N/m].
template <class Visit>
void ForFloorStiffness(const TetModel& model, const NodalVector& x, const NodalVector* start, const Visit& visit) {
  for (const Floor& floor : model.scene().floors) {
    const Mat3 along = floor.normal * floor.normal.transpose();
    const auto depth = [&](const NodalVector& at, std::int32_t n) { return (floor.point - at[n]).dot(floor.normal); };
    for (const ContactNode& contact : model.contact_nodes()) {
      const double d = depth(x, contact.node);
      const FloorResponse response = start == nullptr ? ResponseAt(contact.stiffness, d)
                                                      : ResponseAt(contact.stiffness, d, depth(*start, contact.node));
      if (response.stiffness != 0) visit(static_cast<std::size_t>(contact.node), Mat3(response.stiffness * along));
    }
  }
}

// product += K p, where K contains all floors and contact nodes, in contact or not: an upper bound for anything that
// may come into contact before the stable step is found again.
void AddFloorStiffness(const TetModel& model, const NodalVector& p, NodalVector& product);

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_FLOOR_CONTACT_H_
