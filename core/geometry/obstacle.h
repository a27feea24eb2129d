#ifndef FASCICLE_CORE_GEOMETRY_OBSTACLE_H_
#define FASCICLE_CORE_GEOMETRY_OBSTACLE_H_

#include <memory>
#include <variant>

#include "core/geometry/surface_distance.h"

namespace fascicle {

// The shapes of rigid bodies in their own frames. Lengths in [m].

struct HalfSpace {};  // all points with z <= 0
struct Ball {
  double radius = 0;  // around the origin
};
struct Cuboid {
  Vec3 size = Vec3::Zero();  // edges along the axes, around the origin
};
struct Cylinder {
  double radius = 0, length = 0;  // along z, around the origin, with flat ends
};
// A TriangleMesh is closed and outward (RepairSurface).
using ObstacleShape = std::variant<HalfSpace, Ball, Cuboid, Cylinder, TriangleMesh>;

// The signed distance from a shape, its gradient and its second derivative. Thread-safe.
class ObstacleDistance {
 public:
  // `shape` must outlive the object unchanged.
  explicit ObstacleDistance(const ObstacleShape& shape);

  // At a point of the shape's frame. Where several points of the surface are nearest, it is that of one of them, always
  // the same.
  SignedDistance At(const Vec3& point) const;

 private:
  const ObstacleShape& shape_;
  std::unique_ptr<SurfaceDistance> surface_;  // of a TriangleMesh
};

// The boundary as triangles, for pictures; of a half-space, a square in its plane with this side [m].
TriangleMesh SurfaceOf(const ObstacleShape& shape, double side_of_plane);

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_OBSTACLE_H_
