#ifndef FASCICLE_CORE_SCENE_RIGID_MOTION_H_
#define FASCICLE_CORE_SCENE_RIGID_MOTION_H_

#include <Eigen/Geometry>

#include "core/scene/acting.h"

namespace fascicle {

// A rigid motion at one time: x = R (X - point) + point + translation.
struct RigidMotion {
  Mat3 rotation = Mat3::Identity();
  Vec3 angular_velocity = Vec3::Zero();  // [rad/s]
  Vec3 point = Vec3::Zero();             // [m]
  Vec3 translation = Vec3::Zero();       // [m]
  Vec3 velocity = Vec3::Zero();          // rate of the translation [m/s]

  Vec3 PositionOf(const Vec3& X) const { return rotation * (X - point) + point + translation; }
  Vec3 VelocityOf(const Vec3& X) const { return angular_velocity.cross(rotation * (X - point)) + velocity; }
};

// Motion of a constraint that follows no bone, at a time.
RigidMotion MotionAt(const Motion& motion, double time);
// The same with translations and angle times a factor that changes at `rate` [1/s].
RigidMotion ScaledMotionAt(const Motion& motion, double time, double factor, double rate);

}  // namespace fascicle

#endif  // FASCICLE_CORE_SCENE_RIGID_MOTION_H_
