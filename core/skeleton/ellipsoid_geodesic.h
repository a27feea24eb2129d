#ifndef FASCICLE_CORE_SKELETON_ELLIPSOID_GEODESIC_H_
#define FASCICLE_CORE_SKELETON_ELLIPSOID_GEODESIC_H_

#include <optional>

#include "core/skeleton/wrap_surface.h"

namespace fascicle {

// The line from a to b that touches an ellipsoid, which is the shortest near a line that touches it from `first` to
// `last`, points of the surface. Nothing if no line touches it there. All in the ellipsoid's frame [m].
std::optional<Wrapping> EllipsoidGeodesic(const Vec3& radii, const Vec3& a, const Vec3& b, const Vec3& first,
                                          const Vec3& last);

}  // namespace fascicle

#endif  // FASCICLE_CORE_SKELETON_ELLIPSOID_GEODESIC_H_
