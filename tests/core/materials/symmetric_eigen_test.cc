#include "core/materials/symmetric_eigen.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

#include "core/base/lanes.h"
#include "core/materials/constitutive_model.h"
#include "tests/support/law_checks.h"

namespace fascicle {
namespace {

Mat3 Symmetric(laws::Sampler& sampler, const Vec3& values) {
  const Mat3 Q = sampler.Rotation();
  const Mat3 a = Q * values.asDiagonal() * Q.transpose();
  return 0.5 * (a + a.transpose());
}

Vec3 ValuesOf(int sample, laws::Sampler& sampler) {
  const double s = sampler.LogUniform(0.1, 10), gap = sampler.LogUniform(1e-17, 1);
  switch (sample % 4) {
    case 0:
      return {s, s * (1 + gap), 1 / s};  // two that nearly coincide
    case 1:
      return {s, s * (1 + gap), s * (1 - gap / 2)};  // all three
    case 2:
      return {s, s, s};
    default:
      return {sampler.LogUniform(1e-6, 1e6), sampler.LogUniform(1e-6, 1e6), sampler.LogUniform(1e-6, 1e6)};
  }
}

TEST(SymmetricEigen, RestoresTheMatrixWithAnOrthogonalBasis) {
  laws::Sampler sampler(1);
  for (int i = 0; i < 4000; ++i) {
    const Mat3 a = Symmetric(sampler, ValuesOf(i, sampler));
    const SymmetricEigen<double> eigen(ToNumbers(a));
    const Mat3 V = ToEigen(eigen.vectors);
    const Vec3 values(eigen.values[0], eigen.values[1], eigen.values[2]);
    EXPECT_LE((V.transpose() * V - Mat3::Identity()).norm(), 1e-14);
    EXPECT_LE((V * values.asDiagonal() * V.transpose() - a).norm(), 5e-15 * a.norm());
    Vec3 sorted = values;
    std::sort(sorted.data(), sorted.data() + 3);
    const Vec3 expected = Eigen::SelfAdjointEigenSolver<Mat3>(a).eigenvalues();
    EXPECT_LE((sorted - expected).norm(), 5e-15 * a.norm());
  }
}

TEST(SymmetricEigen, LeavesADiagonalMatrixAlone) {
  const SymmetricEigen<double> eigen(ToNumbers(Mat3(Vec3(3, 1, 2).asDiagonal())));
  EXPECT_EQ(ToEigen(eigen.vectors), Mat3::Identity());
  EXPECT_EQ(Vec3(eigen.values[0], eigen.values[1], eigen.values[2]), Vec3(3, 1, 2));
}

// Each lane has the bits of its matrix alone, whatever its neighbours need.
TEST(SymmetricEigen, LanesDoNotDependOnTheirNeighbours) {
  using Pair = Lanes<double, BaselineSet>;
  laws::Sampler sampler(2);
  for (int i = 0; i < 1000; ++i) {
    const Mat3 a[2] = {Symmetric(sampler, ValuesOf(i, sampler)), Symmetric(sampler, ValuesOf(i + 1, sampler))};
    Matrix3<Pair> both;
    for (int k = 0; k < 9; ++k) {
      const double pair[2] = {a[0].data()[k], a[1].data()[k]};
      both.m[k] = Pair::Load(pair);
    }
    const SymmetricEigen<Pair> eigen(both);
    for (int lane = 0; lane < 2; ++lane) {
      const SymmetricEigen<double> alone(ToNumbers(a[lane]));
      for (int k = 0; k < 9; ++k) EXPECT_EQ(eigen.vectors.m[k][lane], alone.vectors.m[k]);
      for (int k = 0; k < 3; ++k) EXPECT_EQ(eigen.values[k][lane], alone.values[k]);
    }
  }
}

TEST(SymmetricEigen, ReturnsForWhatIsNotFinite) {
  Mat3 broken = Mat3::Identity();
  broken(0, 1) = broken(1, 0) = std::numeric_limits<double>::quiet_NaN();
  (void)SymmetricEigen<double>(ToNumbers(broken));
  broken.setConstant(std::numeric_limits<double>::infinity());
  (void)SymmetricEigen<double>(ToNumbers(broken));
}

}  // namespace
}  // namespace fascicle
