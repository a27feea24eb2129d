#include "core/skeleton/scalar_function.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace fascicle {
namespace {

double PolynomialAt(const std::vector<double>& c, double x, int derivative) {
  double sum = 0;
  for (std::size_t power = c.size(); power-- > static_cast<std::size_t>(derivative);) {
    double factor = 1;
    for (int k = 0; k < derivative; ++k) factor *= static_cast<double>(power) - k;
    sum = sum * x + factor * c[power];
  }
  return sum;
}

// Second derivatives at the points of a cubic spline: M[k-1] h[k-1] + 2 M[k] (h[k-1] + h[k]) + M[k+1] h[k] = 6 (change
// of slope), and at each end -h M[end] + h M[next] = h^2 d, where d is the given third derivative.
std::vector<double> SecondDerivatives(const std::vector<double>& x, const std::vector<double>& y) {
  const std::size_t n = x.size();
  std::vector<double> below(n, 0), diagonal(n, 1), above(n, 0), right(n, 0);
  const auto slope = [&](std::size_t k) { return (y[k + 1] - y[k]) / (x[k + 1] - x[k]); };
  const auto second = [&](std::size_t k) { return (slope(k + 1) - slope(k)) / (x[k + 2] - x[k]); };
  const auto third = [&](std::size_t k) { return 6 * (second(k + 1) - second(k)) / (x[k + 3] - x[k]); };
  for (std::size_t k = 1; k + 1 < n; ++k) {
    below[k] = x[k] - x[k - 1];
    above[k] = x[k + 1] - x[k];
    diagonal[k] = 2 * (below[k] + above[k]);
    right[k] = 6 * (slope(k) - slope(k - 1));
  }
  if (n > 3) {
    const double first = x[1] - x[0], last = x[n - 1] - x[n - 2];
    diagonal[0] = -first;
    above[0] = first;
    right[0] = first * first * third(0);
    diagonal[n - 1] = last;
    below[n - 1] = -last;
    right[n - 1] = last * last * third(n - 4);
  }
  for (std::size_t k = 1; k < n; ++k) {
    const double factor = below[k] / diagonal[k - 1];
    diagonal[k] -= factor * above[k - 1];
    right[k] -= factor * right[k - 1];
  }
  std::vector<double> M(n);
  for (std::size_t k = n; k-- > 0;) M[k] = (right[k] - (k + 1 < n ? above[k] * M[k + 1] : 0)) / diagonal[k];
  return M;
}

}  // namespace

ScalarFunction ScalarFunction::Polynomial(std::vector<double> coefficients) {
  ScalarFunction f;
  f.pieces = {std::move(coefficients)};
  return f;
}

ScalarFunction ScalarFunction::PiecewiseLinear(std::vector<double> x, std::vector<double> y) {
  ScalarFunction f;
  for (std::size_t k = 0; k + 1 < x.size(); ++k) f.pieces.push_back({y[k], (y[k + 1] - y[k]) / (x[k + 1] - x[k])});
  f.breaks = std::move(x);
  return f;
}

ScalarFunction ScalarFunction::Cubic(std::vector<double> x, std::vector<double> y) {
  const std::vector<double> M = SecondDerivatives(x, y);
  ScalarFunction f;
  for (std::size_t k = 0; k + 1 < x.size(); ++k) {
    const double h = x[k + 1] - x[k];
    f.pieces.push_back(
        {y[k], (y[k + 1] - y[k]) / h - h * (2 * M[k] + M[k + 1]) / 6, M[k] / 2, (M[k + 1] - M[k]) / (6 * h)});
  }
  f.breaks = std::move(x);
  return f;
}

ScalarFunction ScalarFunction::LeastJerk(std::vector<double> x, std::vector<double> y) {
  ScalarFunction f;
  for (std::size_t k = 0; k + 1 < x.size(); ++k) {
    const double h = x[k + 1] - x[k], rise = y[k + 1] - y[k], cubed = h * h * h;
    f.pieces.push_back({y[k], 0, 0, 10 * rise / cubed, -15 * rise / (cubed * h), 6 * rise / (cubed * h * h)});
  }
  f.breaks = std::move(x);
  return f;
}

double ScalarFunction::At(double x, int derivative) const {
  if (breaks.empty()) return pieces.empty() ? 0 : PolynomialAt(pieces[0], x, derivative);
  const double inside = std::clamp(x, breaks.front(), breaks.back());
  const auto after = std::upper_bound(breaks.begin() + 1, breaks.end() - 1, inside);
  const auto piece = static_cast<std::size_t>(after - breaks.begin()) - 1;
  const double local = inside - breaks[piece];
  if (x == inside) return PolynomialAt(pieces[piece], local, derivative);
  const double slope = PolynomialAt(pieces[piece], local, 1);
  if (derivative == 0) return PolynomialAt(pieces[piece], local, 0) + slope * (x - inside);
  return derivative == 1 ? slope : 0;
}

ScalarFunction ScalarFunction::Scaled(double factor) const {
  ScalarFunction f = *this;
  for (std::vector<double>& piece : f.pieces) {
    for (double& c : piece) c *= factor;
  }
  return f;
}

}  // namespace fascicle
