#include "core/materials/point_curve.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/check.h"
#include "core/materials/gauss_integral.h"

namespace fascicle {
namespace {

// The slope at a point between two pieces with secants d and widths h: their weighted harmonic mean, zero at an
// extremum.
double InnerSlope(double h0, double d0, double h1, double d1) {
  if (!(d0 * d1 > 0)) return 0;
  const double w0 = 2 * h1 + h0, w1 = h1 + 2 * h0;
  return (w0 + w1) / (w0 / d0 + w1 / d1);
}

// The slope at the last point: that of the parabola through three points, limited so that the last piece is monotone.
double EndSlope(double h0, double d0, double h1, double d1) {
  const double slope = ((2 * h1 + h0) * d1 - h1 * d0) / (h0 + h1);
  if (!(slope * d1 > 0)) return 0;
  const double most = 3 * std::abs(d1);
  return std::clamp(slope, -most, most);
}

std::vector<double> MonotoneSlopes(std::span<const double> at, std::span<const double> values,
                                   PointCurve::Beyond beyond) {
  const std::size_t n = at.size();
  std::vector<double> slopes(n, 0.0), h(n - 1), d(n - 1);
  for (std::size_t i = 0; i + 1 < n; ++i) {
    h[i] = at[i + 1] - at[i];
    d[i] = (values[i + 1] - values[i]) / h[i];
  }
  for (std::size_t i = 1; i + 1 < n; ++i) slopes[i] = InnerSlope(h[i - 1], d[i - 1], h[i], d[i]);
  if (beyond == PointCurve::Beyond::kLine) {
    slopes[n - 1] = n == 2 ? d[0] : EndSlope(h[n - 3], d[n - 3], h[n - 2], d[n - 2]);
  }
  return slopes;
}

}  // namespace

PointCurve::PointCurve(std::span<const double> at, std::span<const double> values, Beyond beyond) {
  FASCICLE_CHECK(at.size() >= 2 && at.size() <= kMostPoints && values.size() == at.size(), "the points are checked");
  SetPieces(at, values, MonotoneSlopes(at, values, beyond));
}

PointCurve::PointCurve(std::span<const double> at, std::span<const double> values, std::span<const double> slopes) {
  FASCICLE_CHECK(at.size() >= 2 && at.size() <= kMostPoints && values.size() == at.size(), "the points are checked");
  SetPieces(at, values, slopes);
}

// Hermite's form: value and slope at both ends of each piece.
void PointCurve::SetPieces(std::span<const double> at, std::span<const double> values, std::span<const double> slopes) {
  points_ = static_cast<std::int64_t>(at.size());
  from_[0] = at[0];
  c_[0][0] = values[0];
  for (std::size_t i = 0; i < at.size(); ++i) {
    from_[i + 1] = at[i];
    c_[i + 1][0] = values[i];
    c_[i + 1][1] = slopes[i];
    if (i + 1 == at.size()) break;
    const double h = at[i + 1] - at[i], d = (values[i + 1] - values[i]) / h;
    c_[i + 1][2] = (3 * d - 2 * slopes[i] - slopes[i + 1]) / h;
    c_[i + 1][3] = (slopes[i] + slopes[i + 1] - 2 * d) / (h * h);
  }
  for (std::size_t i = 1; i < at.size(); ++i) {
    const int piece = static_cast<int>(i);
    integral_[i + 1] = integral_[i] + IntegralOverPiece(piece, at[i], false);
    if (at[0] > 0) {
      integral_over_argument_[i + 1] = integral_over_argument_[i] + IntegralOverPiece(piece, at[i], true);
    }
  }
}

double PointCurve::IntegralOf(double x, bool over_argument) const {
  int piece = 0;
  while (piece < points_ && x >= from_[piece + 1]) ++piece;
  return (over_argument ? integral_over_argument_ : integral_)[piece] + IntegralOverPiece(piece, x, over_argument);
}

// From the beginning of a piece to x.
double PointCurve::IntegralOverPiece(int piece, double x, bool over_argument) const {
  const double begin = from_[piece], s = x - begin;
  const double(&c)[4] = c_[piece];
  if (!over_argument) return s * (c[0] + s * (c[1] / 2 + s * (c[2] / 3 + s * c[3] / 4)));
  if (piece == 0 || piece == points_) return c[1] * s + (c[0] - c[1] * begin) * std::log1p(s / begin);
  // Over a range in which the argument at most doubles, 16 points are exact to round-off.
  const auto over = [&](double t) {
    const double r = t - begin;
    return (c[0] + r * (c[1] + r * (c[2] + r * c[3]))) / t;
  };
  double sum = 0, from = begin;
  for (; x > 2 * from; from *= 2) sum += GaussIntegral(from, 2 * from, over);
  return sum + GaussIntegral(from, x, over);
}

}  // namespace fascicle
