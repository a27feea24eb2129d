#ifndef FASCICLE_CORE_EULERIAN_CONTACT_SURFACE_H_
#define FASCICLE_CORE_EULERIAN_CONTACT_SURFACE_H_

#include <optional>

#include "core/geometry/bounds.h"
#include "core/geometry/triangle_tree.h"

namespace fascicle {

// How far a point is from a surface.
struct SurfaceGap {
  double gap;    // negative inside [m]
  Vec3 normal;   // of the surface there, outwards
  Vec3 nearest;  // the nearest point of the surface [m]
};

// A closed surface that others may touch: signed distances and normals near it. Const, thread-safe.
class ContactSurface {
 public:
  // surface [m], with at least one triangle.
  explicit ContactSurface(TriangleMesh surface);
  ContactSurface(const ContactSurface&) = delete;
  ContactSurface& operator=(const ContactSurface&) = delete;

  const TriangleMesh& surface() const { return surface_; }
  const Bounds& bounds() const { return bounds_; }
  // Of a point within a distance of the surface, on either side; otherwise nothing. The normal is that of the nearest
  // triangle, or points from the nearest edge or corner to the point.
  std::optional<SurfaceGap> GapAt(const Vec3& point, double within) const;

 private:
  TriangleMesh surface_;
  Bounds bounds_;
  std::vector<Vec3> normals_;  // of the nodes, weighted by angle; not of unit length
  TriangleTree tree_;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_CONTACT_SURFACE_H_
