#include "core/geometry/triangle_distance.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <unsupported/Eigen/BVH>

namespace fascicle {
namespace {

using BoundingBox = Eigen::AlignedBox<double, 3>;

double SquaredDistanceToSegment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 edge = b - a;
  const double length = edge.squaredNorm();
  const double s = length > 0 ? std::clamp((p - a).dot(edge) / length, 0.0, 1.0) : 0;
  return (a + s * edge - p).squaredNorm();
}

}  // namespace

// If the projection of p lies in the triangle, the distance to its plane; otherwise the distance to the nearest edge.
double SquaredDistance(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 normal = (b - a).cross(c - a);
  const double area = normal.squaredNorm();
  const bool above = area > 0 && (b - a).cross(p - a).dot(normal) >= 0 && (c - b).cross(p - b).dot(normal) >= 0 &&
                     (a - c).cross(p - c).dot(normal) >= 0;
  if (above) {
    const double height = (p - a).dot(normal);
    return height * height / area;
  }
  return std::min(
      {SquaredDistanceToSegment(p, a, b), SquaredDistanceToSegment(p, b, c), SquaredDistanceToSegment(p, c, a)});
}

struct TriangleDistance::Tree {
  const std::vector<Vec3>& nodes;
  Eigen::KdBVH<double, 3, Triangle> boxes;
};

TriangleDistance::TriangleDistance(const std::vector<Vec3>& nodes, const std::vector<Triangle>& triangles)
    : tree_(new Tree{nodes, {}}) {
  std::vector<BoundingBox> boxes;
  for (const Triangle& t : triangles) {
    BoundingBox box(nodes[t[0]]);
    boxes.push_back(box.extend(nodes[t[1]]).extend(nodes[t[2]]));
  }
  tree_->boxes.init(triangles.begin(), triangles.end(), boxes.begin(), boxes.end());
}

TriangleDistance::~TriangleDistance() = default;

bool TriangleDistance::IsWithin(const Vec3& point, double distance) const {
  struct Search {
    const std::vector<Vec3>& nodes;
    const Vec3& point;
    double reach;
    bool found = false;
    bool intersectVolume(const BoundingBox& box) const { return box.squaredExteriorDistance(point) <= reach; }
    // Returning true ends the search.
    bool intersectObject(const Triangle& t) {
      found = SquaredDistance(point, nodes[t[0]], nodes[t[1]], nodes[t[2]]) <= reach;
      return found;
    }
  };
  Search search{tree_->nodes, point, distance * distance};
  Eigen::BVIntersect(tree_->boxes, search);
  return search.found;
}

}  // namespace fascicle
