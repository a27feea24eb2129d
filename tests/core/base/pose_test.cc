#include "core/base/pose.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

namespace fascicle {
namespace {

// R X against the vector part of q (0, X) q*, multiplied out.
TEST(Pose, RotationFollowsHamiltonsConvention) {
  const Eigen::Quaterniond q = Eigen::Quaterniond(0.3, -0.5, 0.7, 0.2).normalized();
  const Pose pose = {Vec3::Zero(), {q.w(), q.x(), q.y(), q.z()}};
  for (const Vec3& X : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(1, -2, 3)}) {
    const Eigen::Quaterniond turned = q * Eigen::Quaterniond(0, X.x(), X.y(), X.z()) * q.conjugate();
    EXPECT_NEAR((RotationOf(pose) * X - turned.vec()).norm(), 0, 1e-14);
  }
  // A quarter turn about z brings x to y.
  const double h = std::sqrt(0.5);
  EXPECT_NEAR((RotationOf({Vec3::Zero(), {h, 0, 0, h}}) * Vec3::UnitX() - Vec3::UnitY()).norm(), 0, 1e-15);
  EXPECT_EQ(RotationOf(Pose()), Mat3(Mat3::Identity()));
}

}  // namespace
}  // namespace fascicle
