#ifndef FASCICLE_CORE_GEOMETRY_TRIANGLE_DISTANCE_H_
#define FASCICLE_CORE_GEOMETRY_TRIANGLE_DISTANCE_H_

#include <memory>
#include <vector>

#include "core/geometry/tet_mesh.h"

namespace fascicle {

// Distances from points to a set of triangles. Thread-safe.
class TriangleDistance {
 public:
  // `nodes` must outlive the object. There must be at least one triangle.
  TriangleDistance(const std::vector<Vec3>& nodes, const std::vector<Triangle>& triangles);
  ~TriangleDistance();

  // Whether a point is within `distance` [m] of any triangle.
  bool IsWithin(const Vec3& point, double distance) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

// Square of the distance from a point to a triangle [m^2] [Ericson 2005, 5.1.5].
double SquaredDistance(const Vec3& point, const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_TRIANGLE_DISTANCE_H_
