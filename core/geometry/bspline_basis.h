#ifndef FASCICLE_CORE_GEOMETRY_BSPLINE_BASIS_H_
#define FASCICLE_CORE_GEOMETRY_BSPLINE_BASIS_H_

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/problems.h"

namespace fascicle {

// B-spline functions of one degree over a clamped knot vector [Piegl and Tiller 1997, The NURBS Book, 2.2 to 2.5].
class BsplineBasis {
 public:
  static constexpr int kMaxDegree = 5;

  // The degree + 1 functions that don't vanish at a parameter: index of the first one, values and derivatives.
  struct Local {
    int first = 0;
    std::array<double, kMaxDegree + 1> value{}, slope{};
  };

  // A clamped basis on [0, 1] with equally spaced interior knots. CheckSize must accept `degree` and `size`.
  static BsplineBasis Uniform(int degree, int size);
  // CheckKnots must accept `knots`.
  BsplineBasis(int degree, std::vector<double> knots);

  // Reports what is wrong with a degree and a number of functions given by a user.
  static void CheckSize(std::int64_t degree, std::int64_t size, Problems& problems);
  // Reports what is wrong with a knot vector: values that are not finite, descending knots, more than `degree` equal
  // interior knots, ends that are not repeated degree + 1 times.
  static void CheckKnots(int degree, const std::vector<double>& knots, Problems& problems);

  int degree() const { return degree_; }
  // Number of functions.
  int size() const { return static_cast<int>(knots_.size()) - degree_ - 1; }
  const std::vector<double>& knots() const { return knots_; }
  double front() const { return knots_.front(); }
  double back() const { return knots_.back(); }

  // Evaluates at a parameter, which is clamped to the domain.
  Local At(double parameter) const;
  // Greville abscissa of function i. With these as coefficients the spline is the identity.
  double Greville(int i) const;

 private:
  int degree_;
  std::vector<double> knots_;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_BSPLINE_BASIS_H_
