#ifndef FASCICLE_CORE_BASE_CURVE_H_
#define FASCICLE_CORE_BASE_CURVE_H_

#include <vector>

namespace fascicle {

// A function of time that interpolates points; constant before the first and after the last.
struct Curve {
  enum class Interpolation { kLinear, kSmooth };

  std::vector<double> times;   // [s] strictly increasing, at least one
  std::vector<double> values;  // one value for each time
  Interpolation interpolation = Interpolation::kLinear;

  static Curve Constant(double value) { return {{0.0}, {value}, Interpolation::kLinear}; }

  double At(double time) const;
  // Derivative [1/s]. At a point of a linear curve: the slope after the point.
  double RateAt(double time) const;
  // Time of the last point; the curve is constant from there on [s].
  double end() const { return times.back(); }
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_BASE_CURVE_H_
