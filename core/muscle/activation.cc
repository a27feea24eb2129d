#include "core/muscle/activation.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

#include "core/base/line_fitter.h"

namespace fascicle {
namespace {

constexpr std::size_t kMaxPoints = 10'000;

// Three errors add up to less than 1e-4: points left out, the arcs between two steps, and the remaining distance where
// the activation counts as at rest. An arc is at most (step/tau)^2 / 2 where an activation begins to rise, and at most
// (step/T)^2 / 5 where the excitation rises within a time T < tau.
constexpr double kLeftOut = 5e-5;
constexpr double kStepsPerTimeConstant = 256;
constexpr double kStepsPerInterval = 128;
constexpr double kRest = 1e-5;

double TimeConstant(double u, double a, const ActivationDynamics& dynamics) {
  const double slowing = 0.5 + 1.5 * a;
  return u > a ? dynamics.activation_time * slowing : dynamics.deactivation_time / slowing;
}

// The smaller time constant: where a constant excitation equals the activation, the activation may go either way.
double LeastTimeConstant(double a, const ActivationDynamics& dynamics) {
  return std::min(TimeConstant(1, a, dynamics), TimeConstant(0, a, dynamics));
}

// One step of the classical fourth-order Runge-Kutta method.
double Stepped(const Curve& excitation, const ActivationDynamics& dynamics, double time, double a, double step) {
  const auto rate = [&](double offset, double value) {
    const double u = excitation.At(time + offset);
    return (u - value) / TimeConstant(u, value, dynamics);
  };
  const double k1 = rate(0, a);
  const double k2 = rate(step / 2, a + step / 2 * k1);
  const double k3 = rate(step / 2, a + step / 2 * k2);
  const double k4 = rate(step, a + step * k3);
  return std::clamp(a + step / 6 * (k1 + 2 * k2 + 2 * k3 + k4), 0.0, 1.0);
}

// The largest step from `time` that respects `limit` and ends where excitation and activation cross, because the time
// constant jumps there.
double StepBefore(const Curve& excitation, const ActivationDynamics& dynamics, double time, double a, double limit) {
  constexpr double kClose = 1e-7;
  const double ahead = excitation.At(time) - a;
  const double least = 1e-5 * LeastTimeConstant(a, dynamics);
  double step = limit;
  while (step > least) {
    const double ahead_then = excitation.At(time + step) - Stepped(excitation, dynamics, time, a, step);
    if (ahead * ahead_then >= 0 || std::abs(ahead_then) < kClose) break;
    step /= 2;
  }
  return step;
}

// Integrates from `begin` to `end`, between which the excitation is linear. Where the excitation is constant, stops
// once the activation is at rest. Returns the final activation.
double Follow(const Curve& excitation, const ActivationDynamics& dynamics, double begin, double end, double a,
              LineFitter& fitter) {
  const bool held = excitation.At(begin) == excitation.At(end);
  double time = begin;
  while (time < end) {
    const double u = excitation.At(time);
    if (held && std::abs(u - a) <= kRest) break;
    double limit = std::min(LeastTimeConstant(a, dynamics) / kStepsPerTimeConstant, end - time);
    if (!held) limit = std::min(limit, (end - begin) / kStepsPerInterval);
    const double step = StepBefore(excitation, dynamics, time, a, limit);
    a = Stepped(excitation, dynamics, time, a, step);
    time = time + step < end ? time + step : end;
    fitter.Add(time, a);
  }
  return a;
}

}  // namespace

Curve ActivationOf(const Curve& excitation, const ActivationDynamics& dynamics, double duration, Problems& problems) {
  LineFitter fitter(kLeftOut);
  double a = dynamics.initial_activation;
  fitter.Add(0, a);
  double begin = 0;
  for (const double time : excitation.times) {
    if (time <= begin) continue;
    if (time >= duration) break;
    a = Follow(excitation, dynamics, begin, time, a, fitter);
    fitter.Add(time, a);
    begin = time;
  }
  Follow(excitation, dynamics, begin, duration, a, fitter);
  Curve activation = fitter.Finish();
  if (activation.times.size() <= kMaxPoints) return activation;
  problems.Add({},
               "its activation changes so often that a curve needs " + std::to_string(activation.times.size()) +
                   " points for it",
               "at most 10,000: shorten the scene, or let the excitation change less often");
  return Curve::Constant(dynamics.initial_activation);
}

}  // namespace fascicle
