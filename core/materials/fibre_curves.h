#ifndef FASCICLE_CORE_MATERIALS_FIBRE_CURVES_H_
#define FASCICLE_CORE_MATERIALS_FIBRE_CURVES_H_

#include "core/base/numbers.h"

namespace fascicle {

// Curves of the fibre stress. Each has a value, derivative and integral, in closed form except where noted. Pure
// functions, thread-safe.
// [Zajac 1989, Muscle and tendon, Crit. Rev. Biomed. Eng. 17] [Blemker, Pinsky, Delp 2005, J. Biomech. 38]

// Active stress over peak stress as a function of the normalized length r [1]: height 1 at r = 1, zero outside (0.4,
// 1.6). Continuous; the slope jumps at 0.6 (3.6 to 3.2) and at 1.4, as published.
struct ActiveCurve {
  template <class T>
  static T Value(const T& r) {
    const T inner = Select(r <= 1.4, 1 - 4 * (r - 1) * (r - 1), 9 * (r - 1.6) * (r - 1.6));
    const T below = Select(r < 0.6, 9 * (r - 0.4) * (r - 0.4), inner);
    return Select(r <= 0.4, 0, Select(r >= 1.6, 0, below));
  }
  template <class T>
  static T Derivative(const T& r) {
    const T inner = Select(r <= 1.4, -8 * (r - 1), 18 * (r - 1.6));
    const T below = Select(r < 0.6, 18 * (r - 0.4), inner);
    return Select(r <= 0.4, 0, Select(r >= 1.6, 0, below));
  }
  // Integral of the curve from 0 to r.
  template <class T>
  static T Integral(const T& r) {
    // Integral of one of the outer parabolas, and of the curve from 0 to 1.
    constexpr double kOuter = 3 * 0.2 * 0.2 * 0.2;
    constexpr double kHalf = kOuter + 0.4 - 4 * 0.4 * 0.4 * 0.4 / 3;
    const T inner = Select(r <= 1.4, kHalf + (r - 1) - 4.0 / 3.0 * Cube<T>(r - 1), 2 * kHalf + 3 * Cube<T>(r - 1.6));
    const T below = Select(r < 0.6, 3 * Cube<T>(r - 0.4), inner);
    return Select(r <= 0.4, 0, Select(r >= 1.6, 2 * kHalf, below));
  }

 private:
  template <class T>
  static T Cube(const T& x) {
    return x * x * x;
  }
};

// scale (exp(exponent (x - 1)) - 1) for 1 < x < transition, zero below. Above, a straight line that continues value and
// slope. Continuous; the slope jumps at x = 1 from 0 to scale * exponent, as published.
class ExponentialToeCurve {
 public:
  // scale >= 0; exponent > 0; transition > 1.
  ExponentialToeCurve(double scale, double exponent, double transition);
  // With a given slope of the line; the curve's slope then jumps at the transition.
  ExponentialToeCurve(double scale, double exponent, double transition, double slope);

  template <class T>
  T Value(const T& x) const {
    const T toe = scale_ * Expm1(exponent_ * (x - 1));
    return Select(x <= 1, 0, Select(x < transition_, toe, value_ + slope_ * (x - transition_)));
  }
  template <class T>
  T Derivative(const T& x) const {
    const T toe = scale_ * exponent_ * Exp(exponent_ * (x - 1));
    return Select(x <= 1, 0, Select(x < transition_, toe, slope_));
  }
  // Integral of the curve from 1 to x.
  template <class T>
  T Integral(const T& x) const {
    const T u = exponent_ * (x - 1);
    const T toe = scale_ / exponent_ * (Expm1(u) - u);
    const T beyond = x - transition_;
    const T line = integral_ + beyond * (value_ + 0.5 * slope_ * beyond);
    return Select(x <= 1, 0, Select(x < transition_, toe, line));
  }
  // Integral of Value(s)/s from 1 to x. In the toe this is the exponential integral exp(-b) (Ei(b x) - Ei(b)) - ln x,
  // which overflows for a large exponent b and suffers cancellation near x = 1. Gauss quadrature of the positive
  // integrand has neither problem and is exact to round-off.
  template <class T>
  T IntegralOverLength(const T& x) const {
    return Map([&](double s) { return IntegralOverLengthOf(s); }, x);
  }

 private:
  double IntegralOverLengthOf(double x) const;
  // For 1 < x <= transition.
  double ToeIntegralOverLength(double x) const;

  double scale_, exponent_, transition_;
  double value_, slope_, integral_, integral_over_length_;  // at the transition
};

// Fung-type energy of fibres as a function of their strain E: k1/(2 k2) (exp(k2 E^2) - 1) for E > 0, zero below. With
// k2 = 0, its limit k1/2 E^2. The derivative is continuous; the second derivative jumps from 0 to k1 at E = 0.
// [Holzapfel, Gasser, Ogden 2000, J. Elasticity 61, equation 65]
struct FungCurve {
  template <class T>
  T Energy(const T& E) const {
    const T square = E * E;
    return Select(E > 0, 0.5 * k1 * square * ExponentialQuotient<T>(k2 * square), 0);
  }
  template <class T>
  T Derivative(const T& E) const {
    return Select(E > 0, k1 * E * Exp(k2 * E * E), 0);
  }
  template <class T>
  T SecondDerivative(const T& E) const {
    const T exponent = k2 * E * E;
    return Select(E > 0, k1 * (1 + 2 * exponent) * Exp(exponent), 0);
  }

  double k1;  // >= 0 [Pa]
  double k2;  // >= 0
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_MATERIALS_FIBRE_CURVES_H_
