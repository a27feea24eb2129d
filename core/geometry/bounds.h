#ifndef FASCICLE_CORE_GEOMETRY_BOUNDS_H_
#define FASCICLE_CORE_GEOMETRY_BOUNDS_H_

#include <span>

#include "core/base/types.h"

namespace fascicle {

// An axis-aligned box.
struct Bounds {
  Vec3 lowest = Vec3::Zero(), highest = Vec3::Zero();

  Vec3 extent() const { return highest - lowest; }
};

// The bounding box of the points; at the origin if there are none.
inline Bounds BoundsOf(std::span<const Vec3> points) {
  if (points.empty()) return {};
  Bounds bounds = {points.front(), points.front()};
  for (const Vec3& x : points) {
    bounds.lowest = bounds.lowest.cwiseMin(x);
    bounds.highest = bounds.highest.cwiseMax(x);
  }
  return bounds;
}

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_BOUNDS_H_
