#include "core/materials/fibre_curves.h"

#include <algorithm>
#include <cmath>

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
      integral_(scale / exponent * (std::expm1(exponent * (transition - 1)) - exponent * (transition - 1))),
      integral_over_length_(ToeIntegralOverLength(transition)) {}

double ExponentialToeCurve::IntegralOverLengthOf(double x) const {
  if (x <= 1) return 0;
  if (x < transition_) return ToeIntegralOverLength(x);
  const double beyond = x - transition_;
  return integral_over_length_ + slope_ * beyond + (value_ - slope_ * transition_) * std::log1p(beyond / transition_);
}

double ExponentialToeCurve::ToeIntegralOverLength(double x) const {
  // On each piece the exponential grows by at most e^8 and 1/s falls by at most 2/3, so 16 points are exact to
  // round-off.
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
