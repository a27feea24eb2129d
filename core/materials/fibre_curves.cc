#include "core/materials/fibre_curves.h"

#include <algorithm>
#include <array>

namespace fascicle {
namespace {

// Integral of f over [a, b] by the Gauss-Legendre rule of 16 points.
template <class Function>
double GaussIntegral(double a, double b, const Function& f) {
  struct Point {
    double position, weight;
  };
  constexpr std::array<Point, 8> kPoints = {{{0.09501250983763744018, 0.18945061045506849628},
                                             {0.28160355077925891323, 0.18260341504492358886},
                                             {0.45801677765722738634, 0.16915651939500253818},
                                             {0.61787624440264374844, 0.14959598881657673208},
                                             {0.75540440835500303389, 0.12462897125553387205},
                                             {0.86563120238783174388, 0.09515851168249278480},
                                             {0.94457502307323257607, 0.06225352393864789286},
                                             {0.98940093499164993259, 0.02715245941175409485}}};
  const double middle = 0.5 * (a + b);
  const double half = 0.5 * (b - a);
  double sum = 0;
  for (const Point& p : kPoints) sum += p.weight * (f(middle - half * p.position) + f(middle + half * p.position));
  return half * sum;
}

}  // namespace

ExponentialToeCurve::ExponentialToeCurve(double scale, double exponent, double transition)
    : scale_(scale),
      exponent_(exponent),
      transition_(transition),
      value_(scale * std::expm1(exponent * (transition - 1))),
      slope_(scale * exponent * std::exp(exponent * (transition - 1))),
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
