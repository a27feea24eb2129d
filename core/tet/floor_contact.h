#ifndef FASCICLE_CORE_TET_FLOOR_CONTACT_H_
#define FASCICLE_CORE_TET_FLOOR_CONTACT_H_

#include <vector>

#include "core/tet/model.h"

// Floors push nodes of the bodies' surfaces back by a force that grows with how deep they are:
//   f = k_n d n,   energy k_n d^2 / 2,   d = -(x - point).n where that is positive,
// n the floor's normal and k_n of TetModel::contact_nodes(). No friction, so floors keep the bodies' energy.
namespace fascicle {

// Adds the force of all floors on every node [N].
void AddFloorForce(const TetModel& model, const NodalVector& x, NodalVector& force);

// Force of each floor on all bodies [N].
std::vector<Vec3> FloorForces(const TetModel& model, const NodalVector& x);

// Energy stored in all contacts [J].
double FloorEnergy(const TetModel& model, const NodalVector& x);

// Calls visit(node, stiffness) with the 3x3 derivative of minus the force [N/m] of every node that a floor pushes at x.
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

// product += K p with K that of all floors and contact nodes, whether they touch or not: a bound for whatever comes
// into contact until the stable step is found again.
void AddFloorStiffness(const TetModel& model, const NodalVector& p, NodalVector& product);

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_FLOOR_CONTACT_H_
