#ifndef FASCICLE_CORE_GEOMETRY_CAPSULE_SURFACE_H_
#define FASCICLE_CORE_GEOMETRY_CAPSULE_SURFACE_H_

#include "core/geometry/triangle_mesh.h"

namespace fascicle {

// The surface of the convex hull of two balls: a rod with round ends, which tapers if their radii differ; a ball if one
// contains the other. Vertices are on the surface, 24 around the axis. Radii > 0.
TriangleMesh CapsuleSurface(const Vec3& from, double from_radius, const Vec3& to, double to_radius);

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_CAPSULE_SURFACE_H_
