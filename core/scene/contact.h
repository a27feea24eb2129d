#ifndef FASCICLE_CORE_SCENE_CONTACT_H_
#define FASCICLE_CORE_SCENE_CONTACT_H_

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/scene/fields.h"

namespace fascicle {

// Bodies that may touch each other.
struct Contact {
  std::vector<std::int32_t> bodies;  // indices into Scene::bodies; empty: all
  double friction = 0;               // Coulomb's coefficient [1]; only 0 is supported yet
  bool lasting = false;              // whether they stay together where they touch at rest; not supported yet
};
template <>
inline constexpr auto kFieldNames<Contact> = FieldNames("bodies", "friction", "lasting");

// Whether a body is one of the contact's.
bool Touches(const Contact& contact, std::size_t body);

// Two bodies that may touch each other, a < b.
struct TouchingPair {
  std::size_t a = 0, b = 0;  // indices into Scene::bodies
};

// The pairs that contacts name in a scene of so many bodies, ascending.
std::vector<TouchingPair> PairsOf(const std::vector<Contact>& contacts, std::size_t bodies);

}  // namespace fascicle

#endif  // FASCICLE_CORE_SCENE_CONTACT_H_
