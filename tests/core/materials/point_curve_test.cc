// Curves through points: they interpolate, are monotone where the points are, and their slope is continuous.
#include "core/materials/point_curve.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "core/materials/gauss_integral.h"

namespace fascicle {
namespace {

using Beyond = PointCurve::Beyond;

// Steep steps beside flat parts, which a cubic spline overshoots.
constexpr std::array kAt = {0.4, 0.5, 0.52, 0.9, 1.0, 1.3, 1.31, 1.8};
constexpr std::array kValues = {0.0, 0.0, 0.9, 1.0, 1.0, 0.2, 0.0, 0.0};

TEST(PointCurve, InterpolatesWithContinuousSlope) {
  const PointCurve curve(kAt, kValues, Beyond::kConstant);
  for (std::size_t i = 0; i < kAt.size(); ++i) {
    EXPECT_NEAR(curve.At(kAt[i]).value, kValues[i], 1e-15);
    constexpr double kTiny = 1e-11;
    EXPECT_NEAR(curve.At(kAt[i] - kTiny).value, curve.At(kAt[i] + kTiny).value, 1e-8);
    EXPECT_NEAR(curve.At(kAt[i] - kTiny).slope, curve.At(kAt[i] + kTiny).slope, 1e-5);
  }
  for (const double x : {0.0, 0.39, 1.81, 5.0}) {
    EXPECT_EQ(curve.At(x).value, 0);
    EXPECT_EQ(curve.At(x).slope, 0);
  }
}

// Between two points the curve stays between their values, for points at random, too.
TEST(PointCurve, NeverOvershoots) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<double> at = {0.1}, values = {uniform(random)};
    const int count = 2 + trial % 32;
    while (static_cast<int>(at.size()) < count) {
      at.push_back(at.back() + 1e-3 + uniform(random) * (trial % 3 == 0 ? 1e-2 : 1));
      values.push_back(trial % 5 == 0 ? values.back() : std::pow(uniform(random), 4));
    }
    const PointCurve curve(at, values, trial % 2 == 0 ? Beyond::kConstant : Beyond::kLine);
    for (std::size_t i = 0; i + 1 < at.size(); ++i) {
      const double low = std::min(values[i], values[i + 1]), high = std::max(values[i], values[i + 1]);
      for (int k = 0; k <= 20; ++k) {
        const double y = curve.At(at[i] + (at[i + 1] - at[i]) * k / 20).value;
        ASSERT_GE(y, low - 1e-12);
        ASSERT_LE(y, high + 1e-12);
      }
    }
  }
}

// A parabola that rises from zero slope is met to third order, and its line continues the slope.
TEST(PointCurve, ConvergesToASmoothCurve) {
  const auto error = [](int points) {
    std::vector<double> at, values;
    for (int i = 0; i < points; ++i) {
      at.push_back(1 + 0.6 * i / (points - 1));
      values.push_back(std::pow(at.back() - 1, 2));
    }
    const PointCurve curve(at, values, Beyond::kLine);
    double worst = 0;
    for (int k = 0; k <= 600; ++k) {
      const double x = 1 + 1e-3 * k;
      worst = std::max(worst, std::abs(curve.At(x).value - (x - 1) * (x - 1)));
    }
    EXPECT_NEAR(curve.At(2.6).value, curve.At(1.6).value + curve.At(1.6).slope, 1e-14);
    EXPECT_NEAR(curve.At(1.6).slope, 1.2, 1e-10);
    return worst;
  };
  EXPECT_LT(error(33), 0.3 * error(17));
  EXPECT_LT(error(33), 2e-4);
}

TEST(PointCurve, TakesGivenSlopes) {
  // x^3 - x^2 on two pieces is itself.
  const auto f = [](double x) { return x * x * x - x * x; };
  const auto slope = [](double x) { return 3 * x * x - 2 * x; };
  const std::array at = {0.0, 0.7, 2.0};
  const PointCurve curve(at, std::array{f(0.0), f(0.7), f(2.0)}, std::array{slope(0.0), slope(0.7), slope(2.0)});
  for (const double x : {0.1, 0.69, 0.71, 1.5, 1.999}) {
    EXPECT_NEAR(curve.At(x).value, f(x), 1e-14);
    EXPECT_NEAR(curve.At(x).slope, slope(x), 1e-13);
  }
}

// Against quadrature piece by piece.
TEST(PointCurve, Integrals) {
  const PointCurve curve(kAt, kValues, Beyond::kLine);
  for (const double end : {0.2, 0.45, 0.51, 0.95, 1.305, 1.7, 2.5}) {
    double sum = 0, over = 0;
    constexpr int kPieces = 4000;
    for (int i = 0; i < kPieces; ++i) {
      const double a = 0.4 + (end - 0.4) * i / kPieces, b = 0.4 + (end - 0.4) * (i + 1) / kPieces;
      sum += GaussIntegral(a, b, [&](double x) { return curve.At(x).value; });
      over += GaussIntegral(a, b, [&](double x) { return curve.At(x).value / x; });
    }
    EXPECT_NEAR(curve.Integral(end), sum, 1e-9);
    EXPECT_NEAR(curve.IntegralOverArgument(end), over, 1e-9);
  }
}

}  // namespace
}  // namespace fascicle
