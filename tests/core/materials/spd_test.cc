#include "core/materials/spd.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace fascicle {
namespace {

using Vec9 = Eigen::Matrix<double, 9, 1>;

Mat9 RandomMatrix(std::mt19937& random) {
  std::normal_distribution<double> normal;
  Mat9 a;
  for (double& x : a.reshaped()) x = normal(random);
  return a;
}

// Q diag(spectrum) Q^T for a random rotation Q, exactly symmetric.
Mat9 WithSpectrum(const Mat9& Q, const Vec9& spectrum) {
  const Mat9 a = Q * spectrum.asDiagonal() * Q.transpose();
  return 0.5 * (a + a.transpose());
}

Vec9 MixedSpectrum() {
  Vec9 spectrum;
  spectrum << 1e4, 300, 20, 1, 0, -1e-3, -5, -200, -3e3;
  return spectrum;
}

TEST(NearestPositive, RaisesNegativeEigenvaluesAndNothingElse) {
  std::mt19937 random(1);
  for (int i = 0; i < 50; ++i) {
    const Mat9 Q = Eigen::HouseholderQR<Mat9>(RandomMatrix(random)).householderQ();
    const Vec9 spectrum = MixedSpectrum();
    for (const double floor : {0.0, 0.5, 50.0}) {
      const Mat9 expected = WithSpectrum(Q, spectrum.cwiseMax(floor));
      const Mat9 projected = NearestPositive(WithSpectrum(Q, spectrum), floor);
      EXPECT_LE((projected - expected).norm(), 1e-14 * spectrum.norm());
      EXPECT_EQ(projected, projected.transpose());
    }
  }
}

TEST(NearestPositive, ChangesNothingTheSecondTime) {
  std::mt19937 random(2);
  for (int i = 0; i < 50; ++i) {
    Mat9 a = RandomMatrix(random);
    a = (a + a.transpose()).eval();
    for (const double floor : {0.0, 0.1}) {
      const Mat9 once = NearestPositive(a, floor);
      EXPECT_LE((NearestPositive(once, floor) - once).norm(), 1e-14 * once.norm());
    }
  }
}

TEST(NearestPositive, LeavesPositiveMatricesAlone) {
  std::mt19937 random(3);
  for (int i = 0; i < 50; ++i) {
    const Mat9 a = RandomMatrix(random);
    const Mat9 definite = a * a.transpose() + 1e-3 * Mat9::Identity();
    EXPECT_EQ(NearestPositive(definite), definite);
    // Semidefinite, as the tangents of most laws at rest; a Cholesky factorization would be unreliable.
    const Mat9 singular = a.leftCols<6>() * a.leftCols<6>().transpose();
    EXPECT_LE((NearestPositive(singular) - singular).norm(), 1e-14 * singular.norm());
  }
}

// No other positive semidefinite matrix is closer.
TEST(NearestPositive, IsTheNearest) {
  std::mt19937 random(4);
  for (int i = 0; i < 50; ++i) {
    Mat9 a = RandomMatrix(random);
    a = (a + a.transpose()).eval();
    const Mat9 projected = NearestPositive(a);
    const double distance = (projected - a).norm();
    for (int k = 0; k < 20; ++k) {
      const Vec9 v = RandomMatrix(random).col(0);
      const Mat9 other = NearestPositive(projected + 0.1 * (k % 2 == 0 ? 1 : -1) * v * v.transpose());
      EXPECT_GE((other - a).norm(), distance * (1 - 1e-12));
    }
  }
}

TEST(NearestPositive, HandsOnWhatIsNotFinite) {
  Mat9 broken = -Mat9::Identity();
  broken(3, 4) = broken(4, 3) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(NearestPositive(broken).allFinite());
}

}  // namespace
}  // namespace fascicle
