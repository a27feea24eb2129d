#include "core/geometry/bspline_basis.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <string>
#include <utility>

#include "core/base/check.h"

namespace fascicle {
namespace {

bool AllEqual(std::vector<double>::const_iterator begin, std::ptrdiff_t count) {
  return std::all_of(begin, begin + count, [&](double knot) { return knot == *begin; });
}

}  // namespace

BsplineBasis BsplineBasis::Uniform(int degree, int size) {
  std::vector<double> knots;
  const int spans = size - degree;
  for (int i = -degree; i <= spans + degree; ++i) knots.push_back(std::clamp(i, 0, spans) / static_cast<double>(spans));
  return {degree, std::move(knots)};
}

BsplineBasis::BsplineBasis(int degree, std::vector<double> knots) : degree_(degree), knots_(std::move(knots)) {
  Problems problems;
  CheckSize(degree_, size(), problems);
  if (problems.empty()) CheckKnots(degree_, knots_, problems);
  FASCICLE_CHECK(problems.empty(), problems.ToString());
}

void BsplineBasis::CheckSize(std::int64_t degree, std::int64_t size, Problems& problems) {
  if (degree < 1 || degree > kMaxDegree) {
    problems.Add({}, "degree " + std::to_string(degree) + " is not from 1 to " + std::to_string(kMaxDegree));
  } else if (size <= degree) {
    problems.Add({}, std::to_string(size) + " control points are too few for degree " + std::to_string(degree),
                 "give at least " + std::to_string(degree + 1));
  }
}

void BsplineBasis::CheckKnots(int degree, const std::vector<double>& knots, Problems& problems) {
  if (!std::all_of(knots.begin(), knots.end(), [](double knot) { return std::isfinite(knot); })) {
    problems.Add({}, "a knot is not a finite number");
  } else if (!std::is_sorted(knots.begin(), knots.end())) {
    problems.Add({}, "knots descend", "each at least as large as the one before");
  } else if (!AllEqual(knots.begin(), degree + 1) || !AllEqual(knots.end() - degree - 1, degree + 1)) {
    problems.Add({}, "knots are not clamped",
                 "give the first and the last knot " + std::to_string(degree + 1) + " times each");
  } else {
    for (auto knot = knots.begin() + 1; knot + degree < knots.end() - 1; ++knot) {
      if (!AllEqual(knot, degree + 1)) continue;
      problems.Add(
          {}, "more than " + std::to_string(degree) + " interior knots are equal: the solid would be discontinuous");
      return;
    }
  }
}

BsplineBasis::Local BsplineBasis::At(double parameter) const {
  const auto last = knots_.end() - degree_ - 1;
  const double u = std::clamp(parameter, front(), back());
  // The span [knot, next knot) that contains u. The last span contains its end, too.
  const auto next = std::upper_bound(knots_.begin() + degree_ + 1, last, u);
  Local local;
  local.first = static_cast<int>(next - knots_.begin()) - 1 - degree_;
  auto& [first, value, slope] = local;
  value[0] = 1;
  for (int d = 1; d <= degree_; ++d) {
    double carried = 0;
    for (int r = 0; r < d; ++r) {
      const double left = *(next - d + r), right = *(next + r);
      double& N = value[static_cast<std::size_t>(r)];
      const double term = N / (right - left);
      if (d == degree_) {
        slope[static_cast<std::size_t>(r)] -= d * term;
        slope[static_cast<std::size_t>(r + 1)] += d * term;
      }
      N = carried + (right - u) * term;
      carried = (u - left) * term;
    }
    value[static_cast<std::size_t>(d)] = carried;
  }
  return local;
}

double BsplineBasis::Greville(int i) const {
  const auto begin = knots_.begin() + i + 1;
  return std::accumulate(begin, begin + degree_, 0.0) / degree_;
}

}  // namespace fascicle
