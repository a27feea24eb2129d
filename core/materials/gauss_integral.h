#ifndef FASCICLE_CORE_MATERIALS_GAUSS_INTEGRAL_H_
#define FASCICLE_CORE_MATERIALS_GAUSS_INTEGRAL_H_

#include <array>

namespace fascicle {

// Integral of f over [a, b] by the Gauss-Legendre rule with 16 points.
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

}  // namespace fascicle

#endif  // FASCICLE_CORE_MATERIALS_GAUSS_INTEGRAL_H_
