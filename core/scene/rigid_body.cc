#include "core/scene/rigid_body.h"

#include <algorithm>

namespace fascicle {

bool Touches(const RigidBody& rigid, std::size_t body) {
  return rigid.bodies.empty() ||
         std::find(rigid.bodies.begin(), rigid.bodies.end(), static_cast<std::int32_t>(body)) != rigid.bodies.end();
}

RigidMotion RigidMotionAt(const RigidBody& rigid, double time) {
  return rigid.motion ? MotionAt(*rigid.motion, time) : RigidMotion();
}

Pose PoseAfter(const Pose& pose, const RigidMotion& motion) {
  return PoseAt(motion.PositionOf(pose.position),
                (Eigen::Quaterniond(motion.rotation) * QuaternionOf(pose)).normalized());
}

}  // namespace fascicle
