#include "core/scene/rigid_motion.h"

namespace fascicle {

RigidMotion MotionAt(const Motion& motion, double time) {
  RigidMotion at;
  for (int axis = 0; axis < 3; ++axis) {
    if (!motion.translation[axis]) continue;
    at.translation[axis] = motion.translation[axis]->At(time);
    at.velocity[axis] = motion.translation[axis]->RateAt(time);
  }
  if (motion.rotation) {
    const Rotation& rotation = *motion.rotation;
    at.rotation = Eigen::AngleAxisd(rotation.angle.At(time), rotation.axis).toRotationMatrix();
    at.angular_velocity = rotation.angle.RateAt(time) * rotation.axis;
    at.point = rotation.point;
  }
  return at;
}

RigidMotion ScaledMotionAt(const Motion& motion, double time, double factor, double rate) {
  RigidMotion at = MotionAt(motion, time);
  at.velocity = factor * at.velocity + rate * at.translation;
  at.translation *= factor;
  if (motion.rotation) {
    const Rotation& rotation = *motion.rotation;
    const double angle = rotation.angle.At(time);
    at.rotation = Eigen::AngleAxisd(factor * angle, rotation.axis).toRotationMatrix();
    at.angular_velocity = (factor * rotation.angle.RateAt(time) + rate * angle) * rotation.axis;
  }
  return at;
}

}  // namespace fascicle
