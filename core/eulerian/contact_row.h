#ifndef FASCICLE_CORE_EULERIAN_CONTACT_ROW_H_
#define FASCICLE_CORE_EULERIAN_CONTACT_ROW_H_

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/types.h"

namespace fascicle {

// The share of a node in the relative velocity of two bodies across a part of their contact. Row 0 of `weight` is along
// the normal of the contact, rows 1 and 2 along two tangents; columns are along the axes of the body's grid [m^2].
struct ContactPart {
  std::size_t body;
  std::size_t node;
  Mat3 weight;
};

// A part of a contact between two bodies: w = sum of weight v + given is the velocity of one body relative to the
// other, integrated over the area of the part [m^3/s]. Then w[0] >= least, or w[0] = least where bodies stay together,
// and friction opposes w[1] and w[2].
struct ContactRow {
  std::vector<ContactPart> parts;  // ascending by body, then node
  Vec3 given = Vec3::Zero();       // of what moves as prescribed
  double least = 0;
  double friction = 0;  // Coulomb's coefficient [1]
  bool lasting = false;
  std::int32_t floor = -1;  // that a body touches; -1: two bodies touch
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_CONTACT_ROW_H_
