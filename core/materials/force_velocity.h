#ifndef FASCICLE_CORE_MATERIALS_FORCE_VELOCITY_H_
#define FASCICLE_CORE_MATERIALS_FORCE_VELOCITY_H_

#include "core/base/numbers.h"

namespace fascicle {

// Active stress over isometric active stress as a function of the normalized velocity v [1]: the rate of the normalized
// length r over the maximum shortening rate, positive when the fibre lengthens.
//
//   f_v(v) = (1 + v) / (1 - v/a)             for -1 <= v <= 0, zero below: Hill's hyperbola, a = a/F0
//          = 1 + (e - 1) v / (v + d)         for v > 0, with the plateau e and d = (e - 1) a / (1 + a)
//
// With this d the slope at v = 0 is (1 + a)/a on both sides. Continuous; the slope jumps at v = -1 only.
// [Hill 1938, The heat of shortening and the dynamic constants of muscle, Proc. R. Soc. B 126; Zajac 1989; Thelen 2003,
// Adjustment of muscle mechanics model parameters to simulate dynamic contractions in older adults, J. Biomech. Eng.
// 125] Hill measured shortening only. The plateau of lengthening, 1.4 to 1.8 of the isometric force, is from the other
// two sources; the hyperbola towards it is the simplest curve with these properties.
class ForceVelocityCurve {
 public:
  // curvature a > 0; plateau e > 1.
  ForceVelocityCurve(double curvature, double plateau)
      : curvature_(curvature), excess_(plateau - 1), pole_(excess_ * curvature / (1 + curvature)) {}

  template <class T>
  T Value(const T& v) const {
    const T lengthening = 1 + excess_ * v / (v + pole_);
    const T shortening = (1 + v) / (1 - v / curvature_);
    return Select(v > 0, lengthening, Select(v < -1, 0, shortening));
  }
  template <class T>
  T Derivative(const T& v) const {
    const T denominator = 1 - v / curvature_;
    const T lengthening = excess_ * pole_ / ((v + pole_) * (v + pole_));
    const T shortening = (1 + 1 / curvature_) / (denominator * denominator);
    return Select(v > 0, lengthening, Select(v < -1, 0, shortening));
  }

  // Integral of f_act(r) f_v(velocity_per_length (r - from)) over r from `from` to `to`, with f_act the ActiveCurve:
  // the work of a step in which the fibre's normalized length changes so. By quadrature, exact to round-off.
  double ActiveWork(double from, double to, double velocity_per_length) const;

 private:
  double curvature_;  // a
  double excess_;     // e - 1
  double pole_;       // d
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_MATERIALS_FORCE_VELOCITY_H_
