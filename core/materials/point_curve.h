#ifndef FASCICLE_CORE_MATERIALS_POINT_CURVE_H_
#define FASCICLE_CORE_MATERIALS_POINT_CURVE_H_

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/numbers.h"

namespace fascicle {

// A curve through points: cubic between two of them, with continuous slope everywhere. Holds nothing but numbers, and
// is the same for one number and for lanes. Pure functions, thread-safe.
class PointCurve {
 public:
  static constexpr int kMostPoints = 33;

  // What the curve is beyond its last point. Before the first one it is constant, with slope zero.
  enum class Beyond {
    kConstant,  // the slope at the last point is zero
    kLine,      // a straight line that continues value and slope
  };

  // Slopes such that the curve is monotone wherever the points are: neither it nor its extrema overshoot them. [Fritsch
  // & Butland 1984, A method for constructing local monotone piecewise cubic interpolants, SIAM J. Sci. Stat. Comput.
  // 5] Requires `at` strictly increasing, 2 to kMostPoints points, and as many values.
  PointCurve(std::span<const double> at, std::span<const double> values, Beyond beyond);
  // With given slopes; the first one must be zero, and so must the last one unless a line follows.
  PointCurve(std::span<const double> at, std::span<const double> values, std::span<const double> slopes);

  template <class T>
  struct Point {
    T value, slope;
  };
  // Without branches: every piece is looked at.
  template <class T>
  Point<T> At(const T& x) const {
    T from = from_[0], c0 = c_[0][0], c1 = c_[0][1], c2 = c_[0][2], c3 = c_[0][3];
    for (int p = 1; p <= points_; ++p) {
      const auto reached = x >= from_[p];
      from = Select(reached, from_[p], from);
      c0 = Select(reached, c_[p][0], c0);
      c1 = Select(reached, c_[p][1], c1);
      c2 = Select(reached, c_[p][2], c2);
      c3 = Select(reached, c_[p][3], c3);
    }
    const T s = x - from;
    return {c0 + s * (c1 + s * (c2 + s * c3)), c1 + s * (2 * c2 + s * (3 * c3))};
  }

  // The points' positions.
  std::span<const double> at() const { return {from_ + 1, static_cast<std::size_t>(points_)}; }
  // Integrals from the first point to x of the curve, and of the curve over its argument; to round-off. The second one
  // needs positive positions and x.
  double Integral(double x) const { return IntegralOf(x, false); }
  double IntegralOverArgument(double x) const { return IntegralOf(x, true); }

 private:
  void SetPieces(std::span<const double> at, std::span<const double> values, std::span<const double> slopes);
  double IntegralOf(double x, bool over_argument) const;
  double IntegralOverPiece(int piece, double x, bool over_argument) const;

  // Piece p, the cubic sum of c[k] (x - from)^k, begins at from[p]; piece 0 is before the first point.
  double from_[kMostPoints + 1] = {};
  double c_[kMostPoints + 1][4] = {};
  // Integrals from the first point to the beginning of each piece.
  double integral_[kMostPoints + 1] = {}, integral_over_argument_[kMostPoints + 1] = {};
  std::int64_t points_ = 0;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_MATERIALS_POINT_CURVE_H_
