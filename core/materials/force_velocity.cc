#include "core/materials/force_velocity.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/materials/fibre_curves.h"
#include "core/materials/gauss_integral.h"

namespace fascicle {
namespace {

// Integral of f over u in [begin, end], 0 <= begin, where f is a polynomial of low degree over u + pole. In t = ln(1 +
// u/pole) the integrand is a sum of exponentials, however close the pole or long the interval.
template <class Function>
double IntegralBesidePole(double begin, double end, double pole, const Function& f) {
  constexpr double kPiece = 3;  // length of a piece in t: a cubic grows by at most e^9, exact to round-off
  const double first = std::log1p(begin / pole);
  const double length = std::log1p(end / pole) - first;
  const int pieces = std::max(1, static_cast<int>(std::ceil(length / kPiece)));
  double sum = 0;
  for (int i = 0; i < pieces; ++i) {
    sum += GaussIntegral(first + length * i / pieces, first + length * (i + 1) / pieces, [&](double t) {
      const double beyond = pole * std::expm1(t);
      return (beyond + pole) * f(beyond);
    });
  }
  return sum;
}

}  // namespace

double ForceVelocityCurve::ActiveWork(double from, double to, double velocity_per_length) const {
  if (!std::isfinite(from) || !std::isfinite(to)) return from - to;
  const double direction = to < from ? -1 : 1;
  const double pole = (direction < 0 ? curvature_ : pole_) / velocity_per_length;  // as a length from `from`
  double reach = std::abs(to - from);
  if (direction < 0) reach = std::min(reach, 1 / velocity_per_length);  // the active stress is zero at higher speeds
  const auto pull = [&](double distance) {
    const double moved = direction * distance;
    return ActiveCurve::Value(from + moved) * Value(velocity_per_length * moved);
  };
  std::array<double, 4> bends = {0.4, 0.6, 1.4, 1.6};
  for (double& bend : bends) bend = std::clamp(direction * (bend - from), 0.0, reach);
  std::sort(bends.begin(), bends.end());
  double sum = 0;
  for (std::size_t i = 0; i + 1 < bends.size(); ++i) {
    if (bends[i + 1] > bends[i]) sum += IntegralBesidePole(bends[i], bends[i + 1], pole, pull);
  }
  return direction * sum;
}

}  // namespace fascicle
