#include "core/muscle/activation.h"

#include <algorithm>
#include <cmath>

namespace fascicle {
namespace {

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

}  // namespace

// Starts the interval from `begin` to the next point of the excitation, or to the end.
void ActivationPoints::BeginInterval(double begin) {
  begin_ = time_ = begin;
  const auto next = std::upper_bound(excitation_->times.begin(), excitation_->times.end(), begin);
  end_ = next == excitation_->times.end() ? duration_ : std::min(*next, duration_);
}

// The length of the next step in the interval; 0 at its end, or if excitation and activation are constant.
double ActivationPoints::NextStep() const {
  if (!(time_ < end_)) return 0;
  const bool held = excitation_->At(begin_) == excitation_->At(end_);
  if (held && std::abs(excitation_->At(time_) - activation_) <= kRest) return 0;
  double limit = std::min(LeastTimeConstant(activation_, dynamics_) / kStepsPerTimeConstant, end_ - time_);
  if (!held) limit = std::min(limit, (end_ - begin_) / kStepsPerInterval);
  return StepBefore(*excitation_, dynamics_, time_, activation_, limit);
}

bool ActivationPoints::AddNext(LineFitter& fitter) {
  if (!has_begun_) {
    has_begun_ = true;
    fitter.Add(0, activation_);
    BeginInterval(0);
    return true;
  }
  if (const double step = NextStep(); step > 0) {
    activation_ = Stepped(*excitation_, dynamics_, time_, activation_, step);
    time_ = time_ + step < end_ ? time_ + step : end_;
    fitter.Add(time_, activation_);
    return true;
  }
  if (!(end_ < duration_)) return false;
  fitter.Add(end_, activation_);
  BeginInterval(end_);
  return true;
}

void ActivationPoints::Save(ArchiveWriter& archive) const {
  archive.PutInt("has_begun", has_begun_ ? 1 : 0);
  archive.PutDouble("begin", begin_);
  archive.PutDouble("end", end_);
  archive.PutDouble("time", time_);
  archive.PutDouble("activation", activation_);
}

void ActivationPoints::Load(ArchiveReader& archive) {
  has_begun_ = archive.GetInt("has_begun") != 0;
  begin_ = archive.GetDouble("begin");
  end_ = archive.GetDouble("end");
  time_ = archive.GetDouble("time");
  activation_ = archive.GetDouble("activation");
}

IntegratedActivation::IntegratedActivation(const Curve& excitation, const ActivationDynamics& dynamics, double duration)
    : LazyCurve(ActivationPoints(excitation, dynamics, duration), kLeftOut) {}

}  // namespace fascicle
