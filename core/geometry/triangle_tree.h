#ifndef FASCICLE_CORE_GEOMETRY_TRIANGLE_TREE_H_
#define FASCICLE_CORE_GEOMETRY_TRIANGLE_TREE_H_

#include <cstdint>
#include <limits>
#include <stop_token>
#include <utility>
#include <vector>

#include "core/geometry/triangle_mesh.h"

namespace fascicle {

// A bounding volume hierarchy of triangles: nearest points, winding numbers and self-intersections. Results depend only
// on the surface and the query. Thread-safe.
class TriangleTree {
 public:
  struct Nearest {
    Vec3 point;                  // the nearest point of the surface
    double squared_distance;     // from the query point
    std::int32_t triangle = -1;  // the triangle that contains the point
  };

  // `surface` must outlive the tree unchanged and have at least one triangle.
  explicit TriangleTree(const TriangleMesh& surface);

  // The nearest point of those within a distance; triangle -1 if there is none.
  Nearest FindNearest(const Vec3& point, double within = std::numeric_limits<double>::infinity()) const;
  // Adds all triangles that are not farther from a point than `reach`, in no particular order.
  void FindWithin(const Vec3& point, double reach, std::vector<std::int32_t>& triangles) const;
  double Distance(const Vec3& point) const;

  // Generalized winding number of the surface around a point: 1 inside and 0 outside of a closed surface, in between
  // where it is open [Jacobson, Kavan and Sorkine 2013]. Distant triangles are approximated by dipoles [Barill et al.
  // 2018], with an error of a few hundredths.
  double WindingNumber(const Vec3& point) const;
  bool IsInside(const Vec3& point) const { return WindingNumber(point) > 0.5; }
  // Signed distance, negative inside.
  double SignedDistance(const Vec3& point) const;

  // Pairs of triangles that intersect, ascending. Pairs with common nodes count only if they intersect elsewhere.
  // Coplanar triangles are not detected. Throws Stopped after a stop request.
  std::vector<std::pair<std::int32_t, std::int32_t>> CuttingPairs(const std::stop_token& stop = {}) const;

 private:
  struct Box {
    Vec3 lowest, highest;
    Vec3 centre;                        // area-weighted centroid
    Vec3 normal;                        // sum of area vectors
    double radius = 0;                  // of the ball around `centre` that contains all triangles
    std::int32_t end = 0;               // index of the box after this one's descendants
    std::int32_t first = 0, count = 0;  // triangles of a leaf; count is 0 for inner boxes
  };

  std::int32_t Build(std::int32_t first, std::int32_t count);
  double SquaredDistanceTo(const Box& box, const Vec3& point) const;
  void FindCuts(std::int32_t triangle, std::vector<std::pair<std::int32_t, std::int32_t>>& pairs) const;

  const TriangleMesh& surface_;
  std::vector<Vec3> centroids_;
  std::vector<std::int32_t> order_;  // triangles in the order of the leaves
  std::vector<Box> boxes_;           // a box's first child follows it
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_TRIANGLE_TREE_H_
