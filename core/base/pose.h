#ifndef FASCICLE_CORE_BASE_POSE_H_
#define FASCICLE_CORE_BASE_POSE_H_

#include <Eigen/Geometry>
#include <array>

#include "core/base/types.h"

namespace fascicle {

// Position and orientation of a rigid body: point X in the body's frame is at x = position + R X in the world.
struct Pose {
  Vec3 position = Vec3::Zero();  // of the origin of the body's frame, in the world [m]
  // Unit quaternion (w, x, y, z), Hamilton's convention: R X is the vector part of q X q*. q and -q are the same
  // orientation.
  std::array<double, 4> quaternion = {1, 0, 0, 0};
};

// The matrix R of a unit quaternion.
inline Mat3 RotationOf(const Pose& pose) {
  const auto [w, x, y, z] = pose.quaternion;
  Mat3 R;
  R << 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),  //
      2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),   //
      2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y);
  return R;
}

inline Eigen::Quaterniond QuaternionOf(const Pose& pose) {
  const auto [w, x, y, z] = pose.quaternion;
  return {w, x, y, z};
}
// The pose with a unit quaternion.
inline Pose PoseAt(const Vec3& position, const Eigen::Quaterniond& q) {
  return {position, {q.w(), q.x(), q.y(), q.z()}};
}

}  // namespace fascicle

#endif  // FASCICLE_CORE_BASE_POSE_H_
