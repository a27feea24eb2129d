#include "core/geometry/capsule_surface.h"

#include <Eigen/Geometry>

#include <cmath>
#include <numbers>

namespace fascicle {
namespace {

constexpr int kPointsAround = 24;
constexpr int kRings = 8;  // of each ball's part

// A point of a meridian: its place along the axis and its distance from it.
struct ProfilePoint {
  double along, out;
};

// Of the part of a ball from angle a to b [rad], seen from its centre, 0 at the end of the axis. Without its poles.
void AddArc(double centre, double radius, double a, double b, std::vector<ProfilePoint>& profile) {
  for (int k = 0; k <= kRings; ++k) {
    const double angle = a + (b - a) * k / kRings;
    const double out = radius * std::sin(angle);
    if (out > 1e-9 * radius) profile.push_back({centre + radius * std::cos(angle), out});
  }
}

}  // namespace

TriangleMesh CapsuleSurface(const Vec3& from, double from_radius, const Vec3& to, double to_radius) {
  const double length = (to - from).norm();
  const bool ball = length <= std::abs(from_radius - to_radius);
  const Vec3 axis = length > 0 ? Vec3((to - from) / length) : Vec3::UnitZ();
  std::vector<ProfilePoint> profile;
  double lowest = -from_radius, highest = length + to_radius;
  if (ball) {
    const bool is_first = from_radius >= to_radius;
    const double centre = is_first ? 0 : length, radius = is_first ? from_radius : to_radius;
    AddArc(centre, radius, std::numbers::pi, 0, profile);
    lowest = centre - radius;
    highest = centre + radius;
  } else {
    // Where the cone touches both balls.
    const double touch = std::acos((from_radius - to_radius) / length);
    AddArc(0, from_radius, std::numbers::pi, touch, profile);
    AddArc(length, to_radius, touch, 0, profile);
  }
  const Vec3 u = axis.unitOrthogonal(), v = axis.cross(u);
  TriangleMesh mesh;
  mesh.nodes.push_back(from + lowest * axis);
  for (const ProfilePoint& point : profile) {
    for (int k = 0; k < kPointsAround; ++k) {
      const double angle = 2 * std::numbers::pi * k / kPointsAround;
      mesh.nodes.push_back(from + point.along * axis + point.out * (std::cos(angle) * u + std::sin(angle) * v));
    }
  }
  mesh.nodes.push_back(from + highest * axis);
  const auto rings = static_cast<std::int32_t>(profile.size());
  const std::int32_t top = 1 + rings * kPointsAround;
  const auto at = [](std::int32_t ring, int k) { return 1 + ring * kPointsAround + k % kPointsAround; };
  for (int k = 0; k < kPointsAround; ++k) {
    mesh.triangles.push_back({0, at(0, k + 1), at(0, k)});
    for (std::int32_t ring = 0; ring + 1 < rings; ++ring) {
      mesh.triangles.push_back({at(ring, k), at(ring, k + 1), at(ring + 1, k + 1)});
      mesh.triangles.push_back({at(ring, k), at(ring + 1, k + 1), at(ring + 1, k)});
    }
    mesh.triangles.push_back({top, at(rings - 1, k), at(rings - 1, k + 1)});
  }
  return mesh;
}

}  // namespace fascicle
