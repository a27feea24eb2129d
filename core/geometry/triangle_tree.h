#ifndef FASCICLE_CORE_GEOMETRY_TRIANGLE_TREE_H_
#define FASCICLE_CORE_GEOMETRY_TRIANGLE_TREE_H_

#include <cstdint>
#include <utility>
#include <vector>

#include "core/geometry/triangle_mesh.h"

namespace fascicle {

// Boxes around boxes of triangles: nearest points, inside or outside, and where a surface cuts itself. Answers are
// functions of the surface and the point alone. May be asked from several threads at once.
class TriangleTree {
 public:
  struct Nearest {
    Vec3 point;                  // of the surface
    double squared_distance;     // from the point asked for
    std::int32_t triangle = -1;  // that has it
  };

  // `surface` must outlive the tree, unchanged, and has one triangle at least.
  explicit TriangleTree(const TriangleMesh& surface);

  Nearest FindNearest(const Vec3& point) const;
  double Distance(const Vec3& point) const;

  // How often the surface winds round a point: 1 inside of a closed one, 0 outside, between where it is open
  // [Jacobson, Kavan and Sorkine 2013]; far triangles are taken together as dipoles [Barill et al. 2018], which leaves
  // an error of a few hundredths.
  double WindingNumber(const Vec3& point) const;
  bool IsInside(const Vec3& point) const { return WindingNumber(point) > 0.5; }
  // The distance, negative inside.
  double SignedDistance(const Vec3& point) const;

  // Pairs of triangles that cut each other, ascending; those with common nodes when they share more than these.
  // Triangles in one plane are not seen.
  std::vector<std::pair<std::int32_t, std::int32_t>> CuttingPairs() const;

 private:
  struct Box {
    Vec3 lowest, highest;
    Vec3 centre;                        // of area
    Vec3 normal;                        // sum of area vectors
    double radius = 0;                  // of the ball around `centre` that holds all triangles
    std::int32_t end = 0;               // the box after this one's descendants
    std::int32_t first = 0, count = 0;  // triangles of a leaf; count is 0 above the leaves
  };

  std::int32_t Build(std::int32_t first, std::int32_t count);
  double SquaredDistanceTo(const Box& box, const Vec3& point) const;
  void FindCuts(std::int32_t triangle, std::vector<std::pair<std::int32_t, std::int32_t>>& pairs) const;

  const TriangleMesh& surface_;
  std::vector<Vec3> centroids_;
  std::vector<std::int32_t> order_;  // triangles as the leaves have them
  std::vector<Box> boxes_;           // a box's first child follows it
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_TRIANGLE_TREE_H_
