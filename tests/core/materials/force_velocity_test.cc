#include "core/materials/force_velocity.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "core/materials/fibre_curves.h"
#include "core/materials/muscle.h"

namespace fascicle {
namespace {

constexpr std::array kCurvatures = {0.05, 0.25, 1.0};
constexpr std::array kPlateaus = {1.05, 1.4, 1.8};

template <class Check>
void ForAllCurves(const Check& check) {
  for (const double curvature : kCurvatures) {
    for (const double plateau : kPlateaus) check(ForceVelocityCurve(curvature, plateau), curvature, plateau);
  }
}

TEST(ForceVelocityCurve, FollowsHillsEquationWhileShortening) {
  ForAllCurves([](const ForceVelocityCurve& curve, double a, double) {
    // (F + a)(V + b) = (F0 + a) b with V the speed of shortening and b = a vmax.
    for (const double v : {-1.0, -0.7, -0.3, -0.05, 0.0}) {
      EXPECT_NEAR((curve.Value(v) + a) * (-v + a), (1 + a) * a, 1e-15);
    }
    EXPECT_EQ(curve.Value(0), 1);
    EXPECT_EQ(curve.Value(-1), 0);
    EXPECT_EQ(curve.Value(-1.5), 0);
    EXPECT_EQ(curve.Derivative(-1.5), 0);
  });
}

TEST(ForceVelocityCurve, RisesToItsPlateauWhileLengthening) {
  ForAllCurves([](const ForceVelocityCurve& curve, double, double plateau) {
    double last = 1;
    for (const double v : {1e-3, 0.1, 1.0, 10.0, 1e3}) {
      EXPECT_GT(curve.Value(v), last);
      EXPECT_LT(curve.Value(v), plateau);
      last = curve.Value(v);
    }
    EXPECT_NEAR(curve.Value(1e9), plateau, 1e-8);
  });
}

TEST(ForceVelocityCurve, IsSmoothWhereTheFibreIsHeld) {
  ForAllCurves([](const ForceVelocityCurve& curve, double a, double) {
    constexpr double kTiny = 1e-12;
    EXPECT_NEAR(curve.Value(-kTiny), curve.Value(kTiny), 1e-10);
    EXPECT_NEAR(curve.Derivative(-kTiny), (1 + a) / a, 1e-8 * (1 + a) / a);
    EXPECT_NEAR(curve.Derivative(kTiny), (1 + a) / a, 1e-8 * (1 + a) / a);
    EXPECT_NEAR(curve.Value(-1 + kTiny), curve.Value(-1 - kTiny), 1e-11);
  });
}

TEST(ForceVelocityCurve, DerivativeIsThatOfTheValue) {
  ForAllCurves([](const ForceVelocityCurve& curve, double, double) {
    constexpr double kStep = 1e-6;
    for (const double v : {-1.2, -0.9, -0.5, -0.1, 0.01, 0.2, 2.0}) {
      const double difference = (curve.Value(v + kStep) - curve.Value(v - kStep)) / (2 * kStep);
      EXPECT_NEAR(curve.Derivative(v), difference, 1e-6 * std::max(1.0, difference)) << v;
    }
  });
}

// Composite Simpson rule between all kinks of the integrand, with steps that grow with the distance from `from`.
double Work(const ForceVelocityCurve& curve, double from, double to, double rate) {
  const auto pull = [&](double r) { return ActiveCurve::Value(r) * curve.Value(rate * (r - from)); };
  const double direction = to < from ? -1 : 1;
  std::vector<double> ends = {from, to};
  for (const double r : {0.4, 0.6, 1.4, 1.6, from - 1 / rate}) ends.push_back(r);
  for (double distance = 1e-6; distance < 2; distance *= 1.5) ends.push_back(from + direction * distance);
  std::sort(ends.begin(), ends.end());
  double sum = 0;
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    if (ends[i] < std::min(from, to) || ends[i + 1] > std::max(from, to)) continue;
    constexpr int kIntervals = 400;
    const double h = (ends[i + 1] - ends[i]) / kIntervals;
    for (int k = 0; k < kIntervals; k += 2) {
      const double r = ends[i] + k * h;
      // The ends belong to a piece: the value at a kink is the same on both sides.
      sum += (pull(r) + 4 * pull(r + h) + pull(r + 2 * h)) * h / 3;
    }
  }
  return direction * sum;
}

TEST(ForceVelocityCurve, ActiveWorkAgreesWithQuadrature) {
  ForAllCurves([](const ForceVelocityCurve& curve, double, double) {
    for (const double rate : {0.01, 1.0, 30.0, 1e4}) {
      for (const double from : {0.3, 0.5, 0.95, 1.45, 1.7}) {
        for (const double to : {0.2, 0.55, 0.94, 1.0, 1.5, 2.0}) {
          const double expected = Work(curve, from, to, rate);
          EXPECT_NEAR(curve.ActiveWork(from, to, rate), expected, 1e-10 * std::abs(expected))
              << from << " to " << to << " at " << rate;
        }
      }
    }
  });
}

TEST(ForceVelocityCurve, ActiveWorkOfASlowStepIsThatOfAHeldFibre) {
  const ForceVelocityCurve curve(0.25, 1.4);
  EXPECT_NEAR(curve.ActiveWork(0.7, 1.5, 1e-12), ActiveCurve::Integral(1.5) - ActiveCurve::Integral(0.7), 1e-11);
  EXPECT_EQ(curve.ActiveWork(1.1, 1.1, 5), 0);
  EXPECT_FALSE(std::isfinite(curve.ActiveWork(1, std::numeric_limits<double>::quiet_NaN(), 5)));
}

// Cauchy stress along the fibre added by the activation at an incompressible stretch, relative to the isometric one.
double ActiveRatio(const Muscle& muscle, double stretch, double before, double inverse_step) {
  const Mat3 F = Vec3(stretch, 1 / std::sqrt(stretch), 1 / std::sqrt(stretch)).asDiagonal();
  const auto active = [&](double previous, double rate) {
    const FibreState on{Vec3::UnitX(), 1, previous, rate}, off{Vec3::UnitX(), 0, previous, rate};
    return (muscle.Stress(F, on) - muscle.Stress(F, off))(0, 0);
  };
  return active(before, inverse_step) / active(stretch, 0);
}

TEST(Muscle, PullsLessTheFasterItShortens) {
  // 10 optimal lengths per second; the optimal stretch is 1.2, so a change of stretch by 0.012 in 1/500 s is v = 0.5.
  const Muscle muscle(std::array{500.0, 500.0, 1e6, 3e5, 1.2, 0.05, 6.6, 1.4, 10.0, 0.25, 1.4});
  EXPECT_NEAR(ActiveRatio(muscle, 1.1, 1.112, 500), 0.5 / 3, 1e-12);
  EXPECT_NEAR(ActiveRatio(muscle, 1.1, 1.088, 500), 1 + 0.4 * 0.5 / (0.5 + 0.08), 1e-12);
  EXPECT_NEAR(ActiveRatio(muscle, 1.1, 1.1, 500), 1, 1e-12);
  EXPECT_NEAR(ActiveRatio(muscle, 1.1, 1.15, 500), 0, 1e-12);
  const Muscle without_rate(std::array{500.0, 500.0, 1e6, 3e5, 1.2, 0.05, 6.6, 1.4, 0.0, 0.25, 1.4});
  EXPECT_EQ(ActiveRatio(without_rate, 1.1, 1.112, 500), 1);
}

}  // namespace
}  // namespace fascicle
