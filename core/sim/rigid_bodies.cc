#include "core/sim/rigid_bodies.h"

#include "core/geometry/bounds.h"

namespace fascicle {
namespace {

Bounds BoundsOfBodies(const Scene& scene) {
  std::vector<Vec3> corners;
  for (const Body& body : scene.bodies) {
    const Bounds bounds = BoundsOf(body.nodes());
    corners.insert(corners.end(), {bounds.lowest, bounds.highest});
  }
  return BoundsOf(corners);
}

// The pose of a plane whose z axis is the normal and whose origin is below the middle.
Pose PoseOfPlane(const Vec3& point, const Vec3& normal, const Vec3& middle) {
  return PoseAt(middle - (middle - point).dot(normal) * normal,
                Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), normal));
}

}  // namespace

std::vector<RigidBodyInfo> RigidBodiesOf(const Scene& scene) {
  const Bounds bounds = BoundsOfBodies(scene);
  const Vec3 middle = (bounds.lowest + bounds.highest) / 2;
  const double side = 2 * bounds.extent().norm();
  std::vector<RigidBodyInfo> infos;
  for (const Floor& floor : scene.floors) {
    infos.push_back(
        {floor.name, SurfaceOf(HalfSpace(), side), PoseOfPlane(floor.point, floor.normal, middle), false, true});
  }
  for (const RigidBody& rigid : scene.rigid_bodies) {
    RigidBodyInfo& info =
        infos.emplace_back(RigidBodyInfo{rigid.name, SurfaceOf(rigid.shape, side), rigid.pose, rigid.motion.has_value(),
                                         std::holds_alternative<HalfSpace>(rigid.shape)});
    if (!info.unbounded) continue;
    // Its square is moved, not its frame, in which a motion is given.
    const Mat3 R = RotationOf(rigid.pose);
    Vec3 offset = R.transpose() * (middle - rigid.pose.position);
    offset[2] = 0;
    for (Vec3& X : info.shape.nodes) X += offset;
  }
  return infos;
}

std::vector<Pose> PosesOf(const Scene& scene, const Controls& now) {
  std::vector<Pose> poses;
  for (std::size_t k = 0; k < scene.rigid_bodies.size(); ++k) {
    const RigidBody& rigid = scene.rigid_bodies[k];
    if (rigid.motion) poses.push_back(PoseAfter(rigid.pose, now.rigid_motions[k]));
  }
  return poses;
}

}  // namespace fascicle
