#ifndef FASCICLE_CORE_SKELETON_SCALAR_FUNCTION_H_
#define FASCICLE_CORE_SKELETON_SCALAR_FUNCTION_H_

#include <vector>

namespace fascicle {

// A function of one variable with its derivatives, such as the place of a knee along its flexion. Immutable.
class ScalarFunction {
 public:
  // c[0] + c[1] x + c[2] x^2 + ...; no coefficients: 0.
  static ScalarFunction Polynomial(std::vector<double> coefficients);
  static ScalarFunction Constant(double value) { return Polynomial({value}); }
  static ScalarFunction Identity() { return Polynomial({0, 1}); }
  // Through points with strictly increasing x, at least two; continued by the slopes of its ends.
  static ScalarFunction PiecewiseLinear(std::vector<double> x, std::vector<double> y);
  // The cubic spline whose third derivatives at both ends are those of the cubics through the first and the last four
  // points [Forsythe, Malcolm & Moler 1977, 4.4]; of two or three points: the natural one. Continued like the above.
  static ScalarFunction Cubic(std::vector<double> x, std::vector<double> y);

  // The value, or the first or the second derivative.
  double At(double x, int derivative = 0) const;
  // `factor` times this.
  ScalarFunction Scaled(double factor) const;

 private:
  // Pieces begin at x_[k], and the last one ends at x_.back(); c_[k] are the coefficients of the powers of x - x_[k].
  // No x_: one polynomial of any degree.
  std::vector<double> x_;
  std::vector<std::vector<double>> c_;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_SKELETON_SCALAR_FUNCTION_H_
