#ifndef FASCICLE_CORE_MATERIALS_FIBRE_CURVES_H_
#define FASCICLE_CORE_MATERIALS_FIBRE_CURVES_H_

#include <cmath>

namespace fascicle {

// Curves of the fibre's stress; each gives value, derivative and integral in closed form, except where said. All are
// pure and thread-safe.
// [Zajac 1989, Muscle and tendon, Crit. Rev. Biomed. Eng. 17] [Blemker, Pinsky, Delp 2005, J. Biomech. 38]

// Active stress over peak stress as a function of the normalized length r [1]: a hump of height 1 at r = 1 that
// vanishes outside (0.4, 1.6). Continuous; the slope jumps at 0.6 (3.6 to 3.2) and 1.4, as published.
struct ActiveCurve {
  static double Value(double r) {
    if (r <= 0.4 || r >= 1.6) return 0;
    if (r < 0.6) return 9 * (r - 0.4) * (r - 0.4);
    if (r <= 1.4) return 1 - 4 * (r - 1) * (r - 1);
    return 9 * (r - 1.6) * (r - 1.6);
  }
  static double Derivative(double r) {
    if (r <= 0.4 || r >= 1.6) return 0;
    if (r < 0.6) return 18 * (r - 0.4);
    if (r <= 1.4) return -8 * (r - 1);
    return 18 * (r - 1.6);
  }
  // Integral from 0 to r.
  static double Integral(double r) {
    // Integral over one of the outer parabolas, and from 0 to the middle.
    constexpr double kOuter = 3 * 0.2 * 0.2 * 0.2;
    constexpr double kHalf = kOuter + 0.4 - 4 * 0.4 * 0.4 * 0.4 / 3;
    if (r <= 0.4) return 0;
    if (r < 0.6) return 3 * Cube(r - 0.4);
    if (r <= 1.4) return kHalf + (r - 1) - 4 * Cube(r - 1) / 3;
    if (r < 1.6) return 2 * kHalf + 3 * Cube(r - 1.6);
    return 2 * kHalf;
  }

 private:
  static double Cube(double x) { return x * x * x; }
};

// scale (exp(exponent (x - 1)) - 1) for 1 < x < transition, zero before, and beyond it the straight line that goes on
// without a jump in value or slope. Continuous; the slope jumps at x = 1 from 0 to scale * exponent, as published.
class ExponentialToeCurve {
 public:
  // scale >= 0; exponent > 0; transition > 1.
  ExponentialToeCurve(double scale, double exponent, double transition);
  // With a line of another slope: then the curve's own slope jumps at the transition.
  ExponentialToeCurve(double scale, double exponent, double transition, double slope);

  double Value(double x) const {
    if (x <= 1) return 0;
    if (x < transition_) return scale_ * std::expm1(exponent_ * (x - 1));
    return value_ + slope_ * (x - transition_);
  }
  double Derivative(double x) const {
    if (x <= 1) return 0;
    if (x < transition_) return scale_ * exponent_ * std::exp(exponent_ * (x - 1));
    return slope_;
  }
  // Integral from 1 to x.
  double Integral(double x) const {
    if (x <= 1) return 0;
    if (x < transition_) return ToeIntegral(x);
    const double beyond = x - transition_;
    return integral_ + beyond * (value_ + 0.5 * slope_ * beyond);
  }
  // Integral of Value(s)/s from 1 to x. In the toe this is an exponential integral, exp(-b) (Ei(b x) - Ei(b)) - ln x,
  // which overflows for a large exponent b and cancels for x near 1. Gauss quadrature of the positive integrand has
  // neither fault and is exact to round-off.
  double IntegralOverLength(double x) const {
    if (x <= 1) return 0;
    if (x < transition_) return ToeIntegralOverLength(x);
    const double beyond = x - transition_;
    return integral_over_length_ + slope_ * beyond + (value_ - slope_ * transition_) * std::log1p(beyond / transition_);
  }

 private:
  // The integrals for 1 < x <= transition.
  double ToeIntegral(double x) const;
  double ToeIntegralOverLength(double x) const;

  double scale_, exponent_, transition_;
  double value_, slope_, integral_, integral_over_length_;  // at the transition
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_MATERIALS_FIBRE_CURVES_H_
