#ifndef FASCICLE_CORE_BASE_CURVE_H_
#define FASCICLE_CORE_BASE_CURVE_H_

#include <vector>

namespace fascicle {

// A function of time through given points, constant before the first and after the last.
struct Curve {
  enum class Interpolation { kLinear, kSmooth };

  std::vector<double> times;   // [s] strictly increasing, at least one
  std::vector<double> values;  // as many
  Interpolation interpolation = Interpolation::kLinear;

  static Curve Constant(double value) { return {{0.0}, {value}, Interpolation::kLinear}; }

  double At(double time) const;
  // Derivative [1/s]; at a point of a linear curve, the one after it.
  double RateAt(double time) const;
  // The last time at which it changes.
  double end() const { return times.back(); }
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_BASE_CURVE_H_
