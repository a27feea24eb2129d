#ifndef FASCICLE_CORE_SKELETON_SCALAR_FUNCTION_H_
#define FASCICLE_CORE_SKELETON_SCALAR_FUNCTION_H_

#include <vector>

namespace fascicle {

// A function of one variable with its derivatives, such as the place of a knee along its flexion.
struct ScalarFunction {
  // c[0] + c[1] x + c[2] x^2 + ...; no coefficients: 0.
  static ScalarFunction Polynomial(std::vector<double> coefficients);
  static ScalarFunction Constant(double value) { return Polynomial({value}); }
  static ScalarFunction Identity() { return Polynomial({0, 1}); }
  // Through points with strictly increasing x, at least two; continued by the slopes of its ends.
  static ScalarFunction PiecewiseLinear(std::vector<double> x, std::vector<double> y);
  // The cubic spline whose third derivatives at both ends are those of the cubics through the first and the last four
  // points [Forsythe, Malcolm & Moler 1977, 4.4]; of two or three points: the natural one. Continued like the above.
  static ScalarFunction Cubic(std::vector<double> x, std::vector<double> y);
  // Through points, with first and second derivatives of 0 at each and the least jerk between them [Flash & Hogan 1985,
  // The coordination of arm movements, J. Neurosci. 5]; constant beyond them.
  static ScalarFunction LeastJerk(std::vector<double> x, std::vector<double> y);

  // The value, or the first or the second derivative.
  double At(double x, int derivative = 0) const;
  // `factor` times this.
  ScalarFunction Scaled(double factor) const;

  // Pieces begin at breaks[k], and the last one ends at breaks.back(). None: there is one polynomial of any degree.
  std::vector<double> breaks;
  // Coefficients of the powers of x - breaks[k], or of x.
  std::vector<std::vector<double>> pieces;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_SKELETON_SCALAR_FUNCTION_H_
