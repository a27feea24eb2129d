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

  // The degree + 1 functions that don't vanish at a parameter: the first one's index, values and slopes.
  struct Local {
    int first = 0;
    std::array<double, kMaxDegree + 1> value{}, slope{};
  };

  // Clamped on [0, 1] with knots at equal distances inside. 1 <= degree <= kMaxDegree < size as CheckSize says.
  static BsplineBasis Uniform(int degree, int size);
  // `knots` as CheckKnots says.
  BsplineBasis(int degree, std::vector<double> knots);

  // What is wrong with a degree and number of functions that a user gave.
  static void CheckSize(std::int64_t degree, std::int64_t size, Problems& problems);
  // What is wrong with knots: not finite, descending, more than `degree` of them equal inside, an end that is not
  // degree + 1 times there.
  static void CheckKnots(int degree, const std::vector<double>& knots, Problems& problems);

  int degree() const { return degree_; }
  // Number of functions.
  int size() const { return static_cast<int>(knots_.size()) - degree_ - 1; }
  const std::vector<double>& knots() const { return knots_; }
  double front() const { return knots_.front(); }
  double back() const { return knots_.back(); }

  // At a parameter, moved to the nearest end where it is beyond one.
  Local At(double parameter) const;
  // Mean of the knots inside of function i's support: with these as coefficients the spline is the identity.
  double Greville(int i) const;

 private:
  int degree_;
  std::vector<double> knots_;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_BSPLINE_BASIS_H_
