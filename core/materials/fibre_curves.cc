#include "core/materials/fibre_curves.h"

#include <algorithm>

#include "core/materials/gauss_integral.h"

namespace fascicle {

ExponentialToeCurve::ExponentialToeCurve(double scale, double exponent, double transition)
    : ExponentialToeCurve(scale, exponent, transition, scale * exponent * std::exp(exponent * (transition - 1))) {}

ExponentialToeCurve::ExponentialToeCurve(double scale, double exponent, double transition, double slope)
    : scale_(scale),
      exponent_(exponent),
      transition_(transition),
      value_(scale * std::expm1(exponent * (transition - 1))),
      slope_(slope),
      integral_(ToeIntegral(transition)),
      integral_over_length_(ToeIntegralOverLength(transition)) {}

double ExponentialToeCurve::ToeIntegral(double x) const {
  const double u = exponent_ * (x - 1);
  return scale_ / exponent_ * (std::expm1(u) - u);
}

double ExponentialToeCurve::ToeIntegralOverLength(double x) const {
  // Over one piece the exponential grows by e^8 at most and 1/s falls by 2/3 at most: round-off for 16 points.
  const double strain = x - 1;
  const int pieces = std::max(1, static_cast<int>(std::ceil(std::max(exponent_ * strain / 8, strain / 0.5))));
  const double width = strain / pieces;
  double sum = 0;
  for (int i = 0; i < pieces; ++i) {
    sum += GaussIntegral(i * width, (i + 1) * width, [&](double s) { return std::expm1(exponent_ * s) / (1 + s); });
  }
  return scale_ * sum;
}

}  // namespace fascicle
