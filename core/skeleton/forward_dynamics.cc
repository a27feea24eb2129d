#include "core/skeleton/forward_dynamics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

namespace fascicle {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kShortestStep = 1e-10;  // [s]
// Fibres are not shorter than this part of their optimal length.
constexpr double kShortestFibre = 0.01;

// The cosine of the pennation of a fibre, whose thickness across the muscle stays that at the optimal length.
double CosineOf(const LineMuscle& muscle, double fibre) {
  const double sine = std::min(0.999, muscle.optimal_fibre_length * std::sin(muscle.pennation) / fibre);
  return std::sqrt(1 - sine * sine);
}

// Force of the tendon of a muscle of a length, relative to the largest isometric one.
double TendonOf(const LineMuscle& muscle, double length, double fibre) {
  const double tendon = length - fibre * CosineOf(muscle, fibre);
  return muscle.hill.Tendon(tendon / muscle.tendon_slack_length - 1);
}

// Rate of the length of a fibre [m/s].
double FibreRate(const LineMuscle& muscle, double length, double activation, double fibre) {
  const double relative = fibre / muscle.optimal_fibre_length;
  const double isometric = std::max(1e-4, activation * muscle.hill.Active(relative));
  const double force = TendonOf(muscle, length, fibre) / CosineOf(muscle, fibre) - muscle.hill.Passive(relative);
  const double velocity = muscle.hill.Velocity(activation, isometric, force) * muscle.optimal_fibre_length;
  return fibre <= kShortestFibre * muscle.optimal_fibre_length ? std::max(0.0, velocity) : velocity;
}

// The coefficients of the pair of orders 5 and 4.
constexpr std::array<double, 7> kTimes = {0, 1.0 / 5, 3.0 / 10, 4.0 / 5, 8.0 / 9, 1, 1};
constexpr double kStages[7][6] = {{},
                                  {1.0 / 5},
                                  {3.0 / 40, 9.0 / 40},
                                  {44.0 / 45, -56.0 / 15, 32.0 / 9},
                                  {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
                                  {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
                                  {35.0 / 384, 0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84}};
constexpr std::array<double, 7> kErrors = {71.0 / 57600,      0,          -71.0 / 16695, 71.0 / 1920,
                                           -17253.0 / 339200, 22.0 / 525, -1.0 / 40};

}  // namespace

ForwardDynamics::ForwardDynamics(SkeletonMechanics& mechanics, Input input, double tolerance)
    : mechanics_(&mechanics), input_(std::move(input)), tolerance_(tolerance) {}

VectorXd ForwardDynamics::Packed(const SkeletonState& state) const {
  VectorXd y(2 * state.q.size() + 2 * state.activations.size());
  y << state.q, state.rates, state.activations, state.fibre_lengths;
  return y;
}

void ForwardDynamics::Unpack(const VectorXd& y, SkeletonState& state) const {
  const Index n = state.q.size(), m = state.activations.size();
  state.q = y.head(n);
  state.rates = y.segment(n, n);
  state.activations = y.segment(2 * n, m);
  state.fibre_lengths = y.tail(m);
}

VectorXd ForwardDynamics::Rates(double time, const VectorXd& y) {
  const std::vector<LineMuscle>& muscles = mechanics_->skeleton().muscles;
  const auto m = static_cast<Index>(muscles.size());
  const Index n = (y.size() - 2 * m) / 2;
  const VectorXd q = y.head(n), rates = y.segment(n, n);
  const SkeletonInput input = input_(time);
  const MuscleGeometry geometry = GeometryOf(*mechanics_, q);
  VectorXd result(y.size()), forces(m);
  for (Index k = 0; k < m; ++k) {
    const LineMuscle& muscle = muscles[static_cast<std::size_t>(k)];
    const double activation = std::clamp(y[2 * n + k], 0.0, 1.0), fibre = y[2 * n + m + k];
    forces[k] = muscle.max_isometric_force * TendonOf(muscle, geometry.lengths[k], fibre);
    result[2 * n + k] = muscle.hill.ActivationRate(input.excitations[k], activation);
    result[2 * n + m + k] = FibreRate(muscle, geometry.lengths[k], activation, fibre);
  }
  result.head(n) = rates;
  result.segment(n, n) = mechanics_->Accelerations(q, rates, input.forces + geometry.moment_arms * forces);
  return result;
}

SkeletonState ForwardDynamics::Equilibrium(const VectorXd& q, const VectorXd& activations) {
  const std::vector<LineMuscle>& muscles = mechanics_->skeleton().muscles;
  const MuscleGeometry geometry = GeometryOf(*mechanics_, q);
  SkeletonState state{0, q, VectorXd::Zero(q.size()), activations, VectorXd::Zero(activations.size())};
  for (Index k = 0; k < activations.size(); ++k) {
    const LineMuscle& muscle = muscles[static_cast<std::size_t>(k)];
    // Longer fibres have a slower rate: bisection.
    double low = kShortestFibre * muscle.optimal_fibre_length, high = std::max(2 * low, geometry.lengths[k]);
    for (int i = 0; i < 100; ++i) {
      const double middle = (low + high) / 2;
      (FibreRate(muscle, geometry.lengths[k], activations[k], middle) > 0 ? low : high) = middle;
    }
    state.fibre_lengths[k] = low;
  }
  return state;
}

bool ForwardDynamics::Advance(double end, SkeletonState& state) {
  VectorXd y = Packed(state);
  std::array<VectorXd, 7> k;
  while (state.time < end) {
    const double h = std::min(step_, end - state.time);
    VectorXd next, error = VectorXd::Zero(y.size());
    for (std::size_t s = 0; s < k.size(); ++s) {
      next = y;
      for (std::size_t i = 0; i < s; ++i) next += h * kStages[s][i] * k[i];
      k[s] = Rates(state.time + kTimes[s] * h, next);
      error += h * kErrors[s] * k[s];
    }
    const double size = (error.array() / (tolerance_ * y.array().abs().max(1.0))).abs().maxCoeff();
    if (size <= 1) {
      y = next;
      state.time = h == end - state.time ? end : state.time + h;
      Unpack(y, state);
    }
    const double factor = std::isfinite(size) ? 0.9 * std::pow(std::max(size, 1e-5), -0.2) : 0.1;
    const double proposed = h * std::clamp(factor, 0.1, 5.0);
    // A step that only the end made short says little about the next.
    step_ = size <= 1 && h < step_ ? std::max(step_, proposed) : proposed;
    if (step_ < kShortestStep) return false;
  }
  return true;
}

VectorXd ForwardDynamics::TendonForces(const SkeletonState& state) {
  const std::vector<LineMuscle>& muscles = mechanics_->skeleton().muscles;
  const MuscleGeometry geometry = GeometryOf(*mechanics_, state.q);
  VectorXd forces(state.fibre_lengths.size());
  for (Index k = 0; k < forces.size(); ++k) {
    const LineMuscle& muscle = muscles[static_cast<std::size_t>(k)];
    forces[k] = muscle.max_isometric_force * TendonOf(muscle, geometry.lengths[k], state.fibre_lengths[k]);
  }
  return forces;
}

}  // namespace fascicle
