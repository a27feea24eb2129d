#include "core/tet/floor_contact.h"

#include <cmath>

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

// Calls visit(node, response) for every node that a floor acts on.
template <class Visit>
void ForResponses(const TetModel& model, const Floor& floor, const NodalVector& x, const NodalVector* start,
                  const Visit& visit) {
  const auto depth = [&](const NodalVector& at, std::int32_t n) { return (floor.point - at[n]).dot(floor.normal); };
  for (const ContactNode& contact : model.contact_nodes()) {
    const double d = depth(x, contact.node);
    const FloorResponse response = start == nullptr ? ResponseAt(contact.stiffness, d)
                                                    : ResponseAt(contact.stiffness, d, depth(*start, contact.node));
    if (response.stiffness != 0) visit(contact.node, response);
  }
}

}  // namespace

FloorResponse ResponseAt(double k, double d) {
  if (d <= 0) return {};
  return {0.5 * k * d * d, k * d, k};
}

FloorResponse ResponseAt(double k, double d, double start) {
  if ((start >= 0) == (d >= 0) || start == 0) return ResponseAt(k, d);
  if (start < 0) {  // meets the floor: f' = k d^2 / (d - start)
    const double way = d - start;
    return {k * (0.5 * d * d + start * d + start * start * std::log1p(-d / start)), k * d * d / way,
            k * (1 - start * start / (way * way))};
  }
  // Leaves it: f' = k start d / (start - d), a pull.
  const double way = start - d;
  return {-k * start * (d + start * std::log1p(-d / start)), k * start * d / way, k * start * start / (way * way)};
}

void AddFloorForce(const TetModel& model, const NodalVector& x, NodalVector& force, const NodalVector* start) {
  for (const Floor& floor : model.scene().floors) {
    ForResponses(model, floor, x, start,
                 [&](std::int32_t n, const FloorResponse& response) { force[n] += response.force * floor.normal; });
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

double FloorEnergy(const TetModel& model, const NodalVector& x, const NodalVector* start) {
  double energy = 0;
  for (const Floor& floor : model.scene().floors) {
    ForResponses(model, floor, x, start,
                 [&](std::int32_t, const FloorResponse& response) { energy += response.energy; });
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
