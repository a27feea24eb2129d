#include "core/eulerian/contact_surface.h"

#include <Eigen/Geometry>

#include <cmath>
#include <utility>

namespace fascicle {
namespace {

// Barycentric weights of the nearest point below which it counts as a point of an edge or a corner.
constexpr double kOnEdge = 1e-9;
// A point nearer than this part of the edges' size has no direction from an edge.
constexpr double kTouches = 1e-9;

Vec3 AreaVector(const TriangleMesh& surface, std::int32_t triangle) {
  const auto& [a, b, c] = surface.triangles[triangle];
  return (surface.nodes[b] - surface.nodes[a]).cross(surface.nodes[c] - surface.nodes[a]);
}

std::vector<Vec3> NormalsOf(const TriangleMesh& surface) {
  std::vector<Vec3> normals(surface.nodes.size(), Vec3::Zero());
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const Triangle& triangle = surface.triangles[t];
    const Vec3 normal = AreaVector(surface, static_cast<std::int32_t>(t)).normalized();
    for (int c = 0; c < 3; ++c) {
      const Vec3 e = surface.nodes[triangle[(c + 1) % 3]] - surface.nodes[triangle[c]];
      const Vec3 f = surface.nodes[triangle[(c + 2) % 3]] - surface.nodes[triangle[c]];
      normals[triangle[c]] += std::atan2(e.cross(f).norm(), e.dot(f)) * normal;
    }
  }
  return normals;
}

// Barycentric weights of a point of a triangle.
Vec3 WeightsIn(const TriangleMesh& surface, std::int32_t triangle, const Vec3& at) {
  const auto& [a, b, c] = surface.triangles[triangle];
  const Vec3 area = AreaVector(surface, triangle);
  const Vec3 of_a = surface.nodes[a] - at, of_b = surface.nodes[b] - at, of_c = surface.nodes[c] - at;
  return Vec3(of_b.cross(of_c).dot(area), of_c.cross(of_a).dot(area), of_a.cross(of_b).dot(area)) / area.squaredNorm();
}

}  // namespace

ContactSurface::ContactSurface(TriangleMesh surface)
    : surface_(std::move(surface)), bounds_(BoundsOf(surface_.nodes)), normals_(NormalsOf(surface_)), tree_(surface_) {}

std::optional<SurfaceGap> ContactSurface::GapAt(const Vec3& point, double within) const {
  const TriangleTree::Nearest nearest = tree_.FindNearest(point, within);
  if (nearest.triangle < 0) return std::nullopt;
  const Vec3 weights = WeightsIn(surface_, nearest.triangle, nearest.point), away = point - nearest.point;
  const Vec3 area = AreaVector(surface_, nearest.triangle);
  const double distance = away.norm();
  if (weights.minCoeff() > kOnEdge || !(distance > kTouches * std::sqrt(area.norm()))) {
    return SurfaceGap{away.dot(area) < 0 ? -distance : distance, area.normalized(), nearest.point};
  }
  // The mean of the nodes' normals is outwards also where the surface has an edge.
  Vec3 outwards = Vec3::Zero();
  for (int c = 0; c < 3; ++c) outwards += weights[c] * normals_[surface_.triangles[nearest.triangle][c]];
  const double side = away.dot(outwards) < 0 ? -1 : 1;
  return SurfaceGap{side * distance, side / distance * away, nearest.point};
}

}  // namespace fascicle
