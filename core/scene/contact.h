#ifndef FASCICLE_CORE_SCENE_CONTACT_H_
#define FASCICLE_CORE_SCENE_CONTACT_H_

#include <cstdint>
#include <vector>

#include "core/scene/fields.h"

namespace fascicle {

// Bodies that may touch each other.
struct Contact {
  std::vector<std::int32_t> bodies;  // indices into Scene::bodies; empty: all
  double friction = 0;               // Coulomb's coefficient [1]
  bool lasting = false;              // whether they stay together where they touch at rest
};
template <>
inline constexpr auto kFieldNames<Contact> = FieldNames("bodies", "friction", "lasting");

}  // namespace fascicle

#endif  // FASCICLE_CORE_SCENE_CONTACT_H_
