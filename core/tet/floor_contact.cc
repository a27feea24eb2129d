#include "core/tet/floor_contact.h"

namespace fascicle {
namespace {

// Calls visit(contact node, depth) for every node below a floor's surface.
template <class Visit>
void ForNodesIn(const TetModel& model, const Floor& floor, const NodalVector& x, const Visit& visit) {
  for (const ContactNode& contact : model.contact_nodes()) {
    const double depth = (floor.point - x[contact.node]).dot(floor.normal);
    if (depth > 0) visit(contact, depth);
  }
}

}  // namespace

void AddFloorForce(const TetModel& model, const NodalVector& x, NodalVector& force) {
  for (const Floor& floor : model.scene().floors) {
    ForNodesIn(model, floor, x, [&](const ContactNode& contact, double depth) {
      force[contact.node] += contact.stiffness * depth * floor.normal;
    });
  }
}

std::vector<Vec3> FloorForces(const TetModel& model, const NodalVector& x) {
  std::vector<Vec3> forces;
  for (const Floor& floor : model.scene().floors) {
    double push = 0;
    ForNodesIn(model, floor, x, [&](const ContactNode& contact, double depth) { push += contact.stiffness * depth; });
    forces.push_back(push * floor.normal);
  }
  return forces;
}

double FloorEnergy(const TetModel& model, const NodalVector& x) {
  double energy = 0;
  for (const Floor& floor : model.scene().floors) {
    ForNodesIn(model, floor, x,
               [&](const ContactNode& contact, double depth) { energy += 0.5 * contact.stiffness * depth * depth; });
  }
  return energy;
}

void AddFloorStiffness(const TetModel& model, const NodalVector& p, NodalVector& product) {
  for (const Floor& floor : model.scene().floors) {
    for (const ContactNode& contact : model.contact_nodes()) {
      product[contact.node] += contact.stiffness * p[contact.node].dot(floor.normal) * floor.normal;
    }
  }
}

}  // namespace fascicle
