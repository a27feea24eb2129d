#include "core/sim/floor_bodies.h"

#include <Eigen/Geometry>

#include "core/geometry/bounds.h"

namespace fascicle {
namespace {

// In the plane z = 0, counter-clockwise from above.
TriangleMesh Square(double side) {
  const double a = side / 2;
  return {{Vec3(-a, -a, 0), Vec3(a, -a, 0), Vec3(a, a, 0), Vec3(-a, a, 0)}, {{0, 1, 2}, {0, 2, 3}}};
}

// Rotates z to the normal.
Pose PoseOf(const Floor& floor, const Vec3& middle) {
  const Eigen::Quaterniond q = Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), floor.normal);
  return {middle - (middle - floor.point).dot(floor.normal) * floor.normal, {q.w(), q.x(), q.y(), q.z()}};
}

}  // namespace

std::vector<RigidBodyInfo> FloorBodies(const Scene& scene) {
  std::vector<Vec3> corners;
  for (const Body& body : scene.bodies) {
    const Bounds bounds = BoundsOf(body.nodes());
    corners.insert(corners.end(), {bounds.lowest, bounds.highest});
  }
  const Bounds bounds = BoundsOf(corners);
  std::vector<RigidBodyInfo> floors;
  for (const Floor& floor : scene.floors) {
    floors.push_back({floor.name, Square(2 * bounds.extent().norm()),
                      PoseOf(floor, (bounds.lowest + bounds.highest) / 2), false, true});
  }
  return floors;
}

}  // namespace fascicle
