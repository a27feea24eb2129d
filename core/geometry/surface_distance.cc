#include "core/geometry/surface_distance.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace fascicle {
namespace {

// Barycentric weight up to which a point of a triangle is one of an edge or a node; distance, relative to the
// triangle's size, up to which a point has no direction from these.
constexpr double kOnEdge = 1e-9;

}  // namespace

SurfaceDistance::SurfaceDistance(const TriangleMesh& surface)
    : surface_(surface), tree_(surface), of_nodes_(surface.nodes.size(), Vec3::Zero()) {
  const std::vector<Vec3>& x = surface.nodes;
  for (const Triangle& t : surface.triangles) {
    const Vec3 normal = (x[t[1]] - x[t[0]]).cross(x[t[2]] - x[t[0]]).normalized();
    of_faces_.push_back(normal);
    for (int c = 0; c < 3; ++c) {
      const std::int32_t a = t[c], b = t[(c + 1) % 3];
      of_edges_.push_back({std::min(a, b), std::max(a, b), normal});
      const Vec3 forth = x[b] - x[a], back = x[t[(c + 2) % 3]] - x[a];
      of_nodes_[a] += std::atan2(forth.cross(back).norm(), forth.dot(back)) * normal;
    }
  }
  const auto nodes = [](const Edge& edge) { return std::pair(edge.low, edge.high); };
  std::stable_sort(of_edges_.begin(), of_edges_.end(),
                   [&](const Edge& e, const Edge& f) { return nodes(e) < nodes(f); });
  std::size_t count = 0;
  for (const Edge& edge : of_edges_) {
    if (count > 0 && nodes(of_edges_[count - 1]) == nodes(edge)) {
      of_edges_[count - 1].normal += edge.normal;
    } else {
      of_edges_[count++] = edge;
    }
  }
  of_edges_.resize(count);
}

const Vec3& SurfaceDistance::NormalOfEdge(std::int32_t a, std::int32_t b) const {
  const std::pair<std::int32_t, std::int32_t> nodes = std::minmax(a, b);
  return std::lower_bound(of_edges_.begin(), of_edges_.end(), nodes,
                          [](const Edge& edge, const auto& of) { return std::pair(edge.low, edge.high) < of; })
      ->normal;
}

std::optional<SurfaceDistance::Place> SurfaceDistance::At(const Vec3& point, double within) const {
  const TriangleTree::Nearest nearest = tree_.FindNearest(point, within);
  if (nearest.triangle < 0) return std::nullopt;
  const Triangle& t = surface_.triangles[nearest.triangle];
  const Vec3 &a = surface_.nodes[t[0]], &b = surface_.nodes[t[1]], &c = surface_.nodes[t[2]];
  const Vec3 area = (b - a).cross(c - a), at = nearest.point;
  const double weights[3] = {(b - at).cross(c - at).dot(area) / area.squaredNorm(),
                             (c - at).cross(a - at).dot(area) / area.squaredNorm(),
                             (a - at).cross(b - at).dot(area) / area.squaredNorm()};
  int inside = 0, last = 0, missing = 0;
  for (int k = 0; k < 3; ++k) {
    if (weights[k] > kOnEdge) {
      ++inside;
      last = k;
    } else {
      missing = k;
    }
  }
  const std::int32_t begin = t[(missing + 1) % 3], end = t[(missing + 2) % 3];  // of the edge, if it is on one
  Vec3 side = of_faces_[nearest.triangle];
  if (inside == 1) side = of_nodes_[t[last]];
  if (inside == 2) side = NormalOfEdge(begin, end);
  const Vec3 away = point - at;
  const double length = std::sqrt(nearest.squared_distance);
  const double sign = away.dot(side) < 0 ? -1 : 1;
  Place place;
  place.distance = sign * length;
  place.nearest = at;
  if (inside == 3 || !(length > kOnEdge * std::sqrt(area.norm()))) {
    place.normal = side.normalized();
    return place;
  }
  place.normal = sign * away / length;
  // The level sets are spheres about a node and cylinders about an edge.
  place.curvature = (Mat3::Identity() - place.normal * place.normal.transpose()) / place.distance;
  if (inside == 2) {
    const Vec3 edge = (surface_.nodes[end] - surface_.nodes[begin]).normalized();
    place.curvature -= edge * edge.transpose() / place.distance;
  }
  return place;
}

}  // namespace fascicle
