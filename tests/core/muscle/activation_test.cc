#include "core/muscle/activation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace fascicle {
namespace {

constexpr double kTolerance = 1e-4;  // promised
const ActivationDynamics kThelen;
const Curve kFull = Curve::Constant(1);

Curve Activation(const Curve& excitation, const ActivationDynamics& dynamics, double duration) {
  Problems problems;
  const Curve curve = ActivationOf(excitation, dynamics, duration, problems);
  EXPECT_TRUE(problems.empty()) << problems.ToString();
  EXPECT_LE(curve.times.size(), 10'000u);
  for (std::size_t i = 1; i < curve.times.size(); ++i) EXPECT_LT(curve.times[i - 1], curve.times[i]);
  EXPECT_LE(curve.times.back(), duration);
  return curve;
}

// u = 1: t = tau_act (-2 ln(1 - a) - 1.5 a) from rest, by separation of the variables.
TEST(Activation, RisesAsTheClosedForm) {
  for (const double time_constant : {0.002, 0.01, 0.3}) {
    const Curve curve = Activation(kFull, {time_constant, 0.04, 0}, 20 * time_constant);
    for (double a = 0.01; a < 0.9999; a += 0.01) {
      const double time = time_constant * (-2 * std::log(1 - a) - 1.5 * a);
      EXPECT_NEAR(curve.At(time), a, kTolerance) << time;
    }
  }
}

// u = 0: t = 2 tau_deact ln((1 + 3 a)/(4 a)) from full activation.
TEST(Activation, FallsAsTheClosedForm) {
  const Curve curve = Activation(Curve::Constant(0), {0.01, 0.04, 1}, 1);
  for (double a = 0.99; a > 0.001; a -= 0.01) {
    const double time = 2 * 0.04 * std::log((1 + 3 * a) / (4 * a));
    EXPECT_NEAR(curve.At(time), a, kTolerance) << time;
  }
}

// The largest distance from Heun's method with steps so small that its own error is below 1e-6.
double WorstError(const Curve& curve, const Curve& excitation, const ActivationDynamics& dynamics, double duration) {
  const double step = 2e-6 * std::min(dynamics.activation_time, dynamics.deactivation_time) / 0.01;
  const auto rate = [&](double time, double a) {
    const double u = excitation.At(time);
    const double slowing = 0.5 + 1.5 * a;
    return (u - a) / (u > a ? dynamics.activation_time * slowing : dynamics.deactivation_time / slowing);
  };
  double a = dynamics.initial_activation, worst = 0;
  const int steps = static_cast<int>(duration / step);
  for (int i = 0; i < steps; ++i) {
    const double time = i * step;
    worst = std::max(worst, std::abs(curve.At(time) - a));
    const double slope = rate(time, a);
    a += step / 2 * (slope + rate(time + step, a + step * slope));
  }
  return worst;
}

TEST(Activation, FollowsEveryKindOfExcitation) {
  Curve twitches, wave;
  for (int k = 0; k < 20; ++k) {
    const double start = 0.05 * k;
    for (const auto& [offset, value] : {std::pair{0.0, 0.0}, {0.002, 0.9}, {0.008, 0.9}, {0.01, 0.0}}) {
      twitches.times.push_back(start + offset);
      twitches.values.push_back(value);
    }
  }
  for (int k = 0; k <= 200; ++k) {
    wave.times.push_back(0.005 * k);
    wave.values.push_back(0.5 + 0.5 * std::sin(2 * std::numbers::pi * 3 * wave.times.back()));
  }
  const Curve smooth{{0.1, 0.2, 0.5, 0.6}, {0, 1, 0.2, 0.7}, Curve::Interpolation::kSmooth};
  const Curve slow{{0, 1}, {0, 1}, Curve::Interpolation::kLinear};
  for (const Curve& excitation : {twitches, wave, smooth, slow}) {
    for (const ActivationDynamics& dynamics :
         {kThelen, ActivationDynamics{0.005, 0.2, 0.5}, ActivationDynamics{0.04, 0.01, 1}}) {
      EXPECT_LE(WorstError(Activation(excitation, dynamics, 1.2), excitation, dynamics, 1.2), kTolerance);
    }
  }
}

TEST(Activation, NeedsFewPointsAndEndsWhenItRests) {
  const Curve pulse{{0, 0.01, 0.3, 0.31}, {0, 1, 1, 0}, Curve::Interpolation::kLinear};
  const Curve curve = Activation(pulse, kThelen, 1000);
  EXPECT_LT(curve.times.size(), 300u);
  EXPECT_LT(curve.end(), 2);
  EXPECT_NEAR(curve.At(900), 0, kTolerance);
}

TEST(Activation, StaysWhereItIsWhenNothingHappens) {
  const Curve curve = Activation(Curve::Constant(0.3), {0.01, 0.04, 0.3}, 1000);
  EXPECT_EQ(curve.values, std::vector<double>({0.3}));
}

TEST(Activation, ThatTakesTooManyPointsIsAProblem) {
  Curve shaking;
  for (int k = 0; k < 500; ++k) {
    shaking.times.push_back(0.05 * k);
    shaking.values.push_back(k % 2);
  }
  Problems problems;
  EXPECT_EQ(ActivationOf(shaking, kThelen, 1000, problems).times.size(), 1u);
  ASSERT_EQ(problems.count(), 1u);
  EXPECT_NE(problems.kept()[0].hint.find("10,000"), std::string::npos);
}

}  // namespace
}  // namespace fascicle
