#include "core/muscle/activation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace fascicle {
namespace {

constexpr double kTolerance = 1e-4;  // promised
const ActivationDynamics kThelen;
const Curve kFull = Curve::Constant(1);

std::string Saved(const IntegratedActivation& activation) {
  ArchiveWriter archive("activation", 1);
  activation.Save(archive);
  return archive.Finish();
}

// u = 1: t = tau_act (-2 ln(1 - a) - 1.5 a) from rest, by separation of the variables.
TEST(Activation, RisesAsTheClosedForm) {
  for (const double time_constant : {0.002, 0.01, 0.3}) {
    IntegratedActivation activation(kFull, {time_constant, 0.04, 0}, 20 * time_constant);
    for (double a = 0.01; a < 0.9999; a += 0.01) {
      const double time = time_constant * (-2 * std::log(1 - a) - 1.5 * a);
      EXPECT_NEAR(activation.At(time), a, kTolerance) << time;
    }
  }
}

// u = 0: t = 2 tau_deact ln((1 + 3 a)/(4 a)) from full activation.
TEST(Activation, FallsAsTheClosedForm) {
  const Curve off = Curve::Constant(0);
  IntegratedActivation activation(off, {0.01, 0.04, 1}, 1);
  for (double a = 0.99; a > 0.001; a -= 0.01) {
    const double time = 2 * 0.04 * std::log((1 + 3 * a) / (4 * a));
    EXPECT_NEAR(activation.At(time), a, kTolerance) << time;
  }
}

// The largest distance from Heun's method with steps so small that its own error is below 1e-6.
double WorstError(const Curve& excitation, const ActivationDynamics& dynamics, double duration) {
  IntegratedActivation activation(excitation, dynamics, duration);
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
    worst = std::max(worst, std::abs(activation.At(time) - a));
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
      EXPECT_LE(WorstError(excitation, dynamics, 1.2), kTolerance);
    }
  }
}

const Curve kPulse{{0, 0.01, 0.3, 0.31}, {0, 1, 1, 0}, Curve::Interpolation::kLinear};

TEST(Activation, NeedsFewPointsAndRests) {
  IntegratedActivation activation(kPulse, kThelen, 1000);
  EXPECT_FALSE(activation.RestsAt(0.31));
  EXPECT_TRUE(activation.RestsAt(2));
  EXPECT_LT(Saved(activation).size(), 300 * 2 * sizeof(double));
  EXPECT_NEAR(activation.At(900), 0, kTolerance);
  EXPECT_FALSE(activation.RestsAt(0.31)) << "whatever was asked for before";
}

TEST(Activation, StaysConstantWhenExcitationEqualsActivation) {
  const Curve same = Curve::Constant(0.3);
  IntegratedActivation activation(same, {0.01, 0.04, 0.3}, 1000);
  EXPECT_TRUE(activation.RestsAt(0));
  for (const double time : {0.0, 0.1, 1000.0}) EXPECT_EQ(activation.At(time), 0.3);
}

// An excitation that never becomes constant needs no memory for past times.
TEST(Activation, ForgetsThePast) {
  Curve shaking;
  for (int k = 0; k < 400; ++k) {
    shaking.times.push_back(0.05 * k);
    shaking.values.push_back(k % 2);
  }
  IntegratedActivation all(shaking, kThelen, 20), last(shaking, kThelen, 20);
  for (double time = 0; time < 20; time += 0.01) {
    EXPECT_EQ(last.At(time), all.At(time));
    last.DiscardBefore(time);
  }
  EXPECT_GT(Saved(all).size(), 2000 * sizeof(double));
  EXPECT_LT(Saved(last).size(), 100 * sizeof(double));
}

// The bits do not depend on earlier evaluations, nor on saving and loading.
TEST(Activation, HasTheSameBitsHoweverItIsAskedAndAfterALoad) {
  IntegratedActivation whole(kPulse, kThelen, 1);
  whole.At(1);
  for (const double saved_at : {0.0, 0.005, 0.05, 0.3, 0.305, 0.9}) {
    IntegratedActivation first(kPulse, kThelen, 1);
    EXPECT_EQ(first.At(saved_at), whole.At(saved_at));
    first.At(saved_at + 0.01);  // as for the next step
    first.DiscardBefore(saved_at);
    IntegratedActivation second(kPulse, kThelen, 1);
    const std::string bytes = Saved(first);
    ArchiveReader archive(bytes, "activation", 1);
    second.Load(archive);
    ASSERT_TRUE(archive.AtEnd());
    for (double time = saved_at; time < 1; time += 0.0007) ASSERT_EQ(second.At(time), whole.At(time)) << saved_at;
    EXPECT_TRUE(second.RestsAt(1));
  }
}

}  // namespace
}  // namespace fascicle
