#ifndef FASCICLE_CORE_EULERIAN_CONTACT_ROW_H_
#define FASCICLE_CORE_EULERIAN_CONTACT_ROW_H_

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/types.h"

namespace fascicle {

// The share of a node in the relative velocity of two bodies across a part of their contact.
struct ContactPart {
  std::size_t body;
  std::size_t node;
  Vec3 weight;  // along the axes of the body's grid [m^2]
};

// A part of a contact between two bodies: w = sum of weight . v is the velocity of one body relative to the other along
// the normal, integrated over the area of the part [m^3/s]. Then w >= least.
struct ContactRow {
  std::vector<ContactPart> parts;  // ascending by body, then node
  double area = 0;                 // [m^2]
  double least = 0;
  std::int32_t floor = -1;  // that a body touches; -1: two bodies touch
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_CONTACT_ROW_H_
