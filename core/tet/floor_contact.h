#ifndef FASCICLE_CORE_TET_FLOOR_CONTACT_H_
#define FASCICLE_CORE_TET_FLOOR_CONTACT_H_

#include <vector>

#include "core/tet/model.h"

// Floors: penalty forces on surface nodes below a plane,
//   f = k_n d n,   energy k_n d^2 / 2,   d = -(x - point).n where positive,
// with the floor's normal n and the stiffness k_n of TetModel::contact_nodes(). Without friction, so energy is
// conserved.
namespace fascicle {

// Adds the force of all floors to every node [N].
void AddFloorForce(const TetModel& model, const NodalVector& x, NodalVector& force);

// Force of each floor on all bodies [N].
std::vector<Vec3> FloorForces(const TetModel& model, const NodalVector& x);

// Energy stored in all contacts [J].
double FloorEnergy(const TetModel& model, const NodalVector& x);

// Calls visit(node, stiffness) for every node in contact at x, with the 3x3 derivative of minus the force [N/m].
template <class Visit>
void ForFloorStiffness(const TetModel& model, const NodalVector& x, const Visit& visit) {
  for (const Floor& floor : model.scene().floors) {
    const Mat3 along = floor.normal * floor.normal.transpose();
    for (const ContactNode& contact : model.contact_nodes()) {
      if ((x[contact.node] - floor.point).dot(floor.normal) < 0) {
        visit(static_cast<std::size_t>(contact.node), Mat3(contact.stiffness * along));
      }
    }
  }
}

// product += K p, where K contains all floors and contact nodes, in contact or not: an upper bound for anything that
// may come into contact before the stable step is found again.
void AddFloorStiffness(const TetModel& model, const NodalVector& p, NodalVector& product);

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_FLOOR_CONTACT_H_
