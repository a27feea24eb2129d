#include "core/skeleton/placement.h"

#include <algorithm>
#include <cmath>

namespace fascicle {

Pose PoseByAngles(const Vec3& position, const Vec3& angles) {
  return PoseAt(position, Eigen::AngleAxisd(angles.x(), Vec3::UnitX()) * Eigen::AngleAxisd(angles.y(), Vec3::UnitY()) *
                              Eigen::AngleAxisd(angles.z(), Vec3::UnitZ()));
}

Vec3 AnglesOf(const Pose& pose) {
  const Mat3 R = RotationOf(pose);
  const double y = std::asin(std::clamp(R(0, 2), -1.0, 1.0));
  // At 90 degrees about y, only the sum or the difference of the others counts.
  if (std::hypot(R(0, 0), R(0, 1)) < 1e-12) return {std::atan2(R(1, 0), R(1, 1)), y, 0};
  return {std::atan2(-R(1, 2), R(2, 2)), y, std::atan2(-R(0, 1), R(0, 0))};
}

Pose operator*(const Pose& outer, const Pose& inner) {
  return PoseAt(outer.position + RotationOf(outer) * inner.position, QuaternionOf(outer) * QuaternionOf(inner));
}

}  // namespace fascicle
