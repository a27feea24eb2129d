#include "core/skeleton/hill_muscle.h"

#include <cmath>

namespace fascicle {
namespace {

// Of the tendon: force at the end of its exponential part, and that part's exponent [Thelen 2003, table 1].
constexpr double kToeForce = 1.0 / 3, kToeShape = 3;
// Beyond this part of the largest force of a lengthening fibre, its velocity grows linearly.
constexpr double kLinearBeyond = 0.95;

}  // namespace

double HillCurves::Active(double length) const { return std::exp(-(length - 1) * (length - 1) / active_width); }

double HillCurves::Passive(double length) const {
  if (is_early && length < 1 + passive_strain) return std::exp(passive_shape * ((length - 1) / passive_strain - 1));
  if (length <= 1) return 0;
  const double strain = length - 1;
  if (strain > passive_strain) {
    const double end = std::exp(passive_shape);
    return 1 + passive_shape / passive_strain * end / (end - 1) * (strain - passive_strain);
  }
  return std::expm1(passive_shape * strain / passive_strain) / std::expm1(passive_shape);
}

double HillCurves::Tendon(double strain) const {
  const double always = is_early ? 0.001 * (1 + strain) : 0;
  if (strain <= 0) return always;
  // The line continues the exponential part with its slope, and bears 1 at `tendon_strain`.
  const double end = std::exp(kToeShape);
  const double toe = tendon_strain * (is_early ? 0.609 : 1 / (1 + (1 / kToeForce - 1) * (end - 1) / (kToeShape * end)));
  if (strain <= toe) return always + kToeForce * std::expm1(kToeShape * strain / toe) / std::expm1(kToeShape);
  return always + kToeForce + (1 - kToeForce) * (strain - toe) / (tendon_strain - toe);
}

double HillCurves::Velocity(double activation, double isometric, double force) const {
  const double fastest = (0.25 + 0.75 * activation) * max_shortening_velocity;
  const auto at = [&](double f) {
    const double b = f <= isometric
                         ? isometric + f / velocity_shape
                         : (2 + 2 / velocity_shape) * (isometric * lengthening_force - f) / (lengthening_force - 1);
    return fastest * (f - isometric) / b;
  };
  if (force < 0) {
    // With the slope at a force of 0.
    return fastest * (-1 + force / isometric * (1 + 1 / velocity_shape));
  }
  const double end = kLinearBeyond * isometric * lengthening_force;
  if (force <= end) return at(force);
  const double step = 1e-4 * end;
  return at(end) + (at(end) - at(end - step)) / step * (force - end);
}

double HillCurves::ForceAt(double activation, double velocity) const {
  const double v = velocity / ((0.25 + 0.75 * activation) * max_shortening_velocity);
  if (v <= 0) return v <= -1 ? 0 : (1 + v) / (1 - v / velocity_shape);
  const double c = (2 + 2 / velocity_shape) / (lengthening_force - 1);
  return (1 + v * c * lengthening_force) / (1 + v * c);
}

double HillCurves::ActivationRate(double excitation, double activation) const {
  const double factor = is_early ? 1 : 0.5 + 1.5 * activation;
  return (excitation - activation) / (excitation > activation ? activation_time * factor : deactivation_time / factor);
}

}  // namespace fascicle
