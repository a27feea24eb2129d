#include "core/materials/rotation.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <random>

namespace fascicle {
namespace {

class RotationTest : public ::testing::Test {
 protected:
  Mat3 Random() {
    Mat3 a;
    for (double& x : a.reshaped()) x = normal_(random_);
    return a;
  }
  Mat3 RandomRotation() {
    return Eigen::Quaterniond(normal_(random_), normal_(random_), normal_(random_), normal_(random_))
        .normalized()
        .toRotationMatrix();
  }

  std::mt19937 random_{5};
  std::normal_distribution<double> normal_;
};

void ExpectRotation(const Mat3& R) {
  EXPECT_LE((R.transpose() * R - Mat3::Identity()).norm(), 1e-14);
  EXPECT_NEAR(R.determinant(), 1, 1e-14);
}

// F = Q U with symmetric positive definite U gives back Q, up to the condition number of U.
TEST_F(RotationTest, IsThePolarFactor) {
  for (int i = 0; i < 2000; ++i) {
    const Mat3 Q = RandomRotation(), V = RandomRotation();
    const Vec3 stretches = (2 * Vec3(normal_(random_), normal_(random_), normal_(random_))).array().exp();
    const Mat3 F = Q * V * stretches.asDiagonal() * V.transpose();
    const Mat3 R = NearestRotation(F);
    ExpectRotation(R);
    const double condition = stretches.maxCoeff() / (stretches.sum() - stretches.maxCoeff());
    EXPECT_LE((R - Q).norm(), 1e-14 * (10 + condition));
  }
}

TEST_F(RotationTest, BothWaysAgree) {
  for (int i = 0; i < 500; ++i) {
    Mat3 F = Random();
    if (F.determinant() < 0) F = -F;
    if (F.determinant() < 0.05) continue;
    EXPECT_LE((NearestRotation(F) - NearestRotationBySvd(F)).norm(), 1e-13);
  }
}

// Also for inverted and degenerate gradients: no rotation is closer.
TEST_F(RotationTest, IsNearestAlsoWhenInverted) {
  for (int i = 0; i < 200; ++i) {
    Mat3 F = Random();
    if (F.determinant() > 0) F = -F;
    if (i % 10 == 0) F.col(2) = F.col(0) + F.col(1);
    const Mat3 R = NearestRotation(F);
    ExpectRotation(R);
    const double closeness = (R.transpose() * F).trace();
    for (int k = 0; k < 50; ++k) {
      const Mat3 nearby = R * Eigen::AngleAxisd(0.2 * normal_(random_), RandomRotation().col(0)).toRotationMatrix();
      EXPECT_LE((nearby.transpose() * F).trace(), closeness + 1e-12 * F.norm());
      EXPECT_LE((RandomRotation().transpose() * F).trace(), closeness + 1e-12 * F.norm());
    }
  }
}

TEST_F(RotationTest, SurvivesExtremesOfSize) {
  for (const double size : {1e-30, 1e-5, 1e5, 1e30}) {
    const Mat3 Q = RandomRotation();
    EXPECT_LE((NearestRotation(size * Q) - Q).norm(), 1e-14);
  }
  ExpectRotation(NearestRotation(Mat3::Zero()));
  Mat3 broken = Mat3::Identity();
  broken(0, 2) = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(NearestRotation(broken).allFinite());
}

}  // namespace
}  // namespace fascicle
