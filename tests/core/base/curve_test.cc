#include "core/base/curve.h"

#include <gtest/gtest.h>

namespace fascicle {
namespace {

const Curve kLinear{{1, 2, 4}, {3, 5, 1}, Curve::Interpolation::kLinear};
const Curve kSmooth{{1, 2, 4}, {3, 5, 1}, Curve::Interpolation::kSmooth};

TEST(CurveTest, ConstantOutside) {
  for (const Curve& curve : {kLinear, kSmooth}) {
    EXPECT_EQ(curve.At(-7), 3);
    EXPECT_EQ(curve.At(1), 3);
    EXPECT_EQ(curve.At(4), 1);
    EXPECT_EQ(curve.At(100), 1);
    EXPECT_EQ(curve.RateAt(0.999), 0);
    EXPECT_EQ(curve.RateAt(4), 0);
  }
  EXPECT_EQ(Curve::Constant(2).At(0), 2);
  EXPECT_EQ(Curve::Constant(2).RateAt(5), 0);
}

TEST(CurveTest, Linear) {
  EXPECT_DOUBLE_EQ(kLinear.At(1.25), 3.5);
  EXPECT_DOUBLE_EQ(kLinear.At(3), 3);
  EXPECT_DOUBLE_EQ(kLinear.RateAt(1), 2);
  // At a point, the rate is that of the following piece.
  EXPECT_DOUBLE_EQ(kLinear.RateAt(2), -2);
}

TEST(CurveTest, SmoothHasNoJumpInItsRate) {
  EXPECT_DOUBLE_EQ(kSmooth.At(1.5), 4);
  EXPECT_DOUBLE_EQ(kSmooth.At(2), 5);
  EXPECT_DOUBLE_EQ(kSmooth.RateAt(1.5), 3);
  for (const double point : {1.0, 2.0, 4.0}) {
    EXPECT_NEAR(kSmooth.RateAt(point - 1e-9), 0, 1e-7);
    EXPECT_NEAR(kSmooth.RateAt(point + 1e-9), 0, 1e-7);
  }
}

TEST(CurveTest, RateIsTheDerivative) {
  for (const Curve& curve : {kLinear, kSmooth}) {
    for (const double t : {1.1, 1.7, 2.3, 3.9}) {
      EXPECT_NEAR(curve.RateAt(t), (curve.At(t + 1e-6) - curve.At(t - 1e-6)) / 2e-6, 1e-8);
    }
  }
}

}  // namespace
}  // namespace fascicle
