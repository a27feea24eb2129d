#include "core/base/curve.h"

#include <algorithm>
#include <cstddef>

namespace fascicle {
namespace {

// Index of the last point at or before `time`. Requires such a point with another one after it.
std::size_t IntervalOf(const Curve& curve, double time) {
  return static_cast<std::size_t>(std::upper_bound(curve.times.begin(), curve.times.end(), time) -
                                  curve.times.begin()) -
         1;
}

}  // namespace

double Curve::At(double time) const {
  if (time < times.front()) return values.front();
  if (time >= times.back()) return values.back();
  const std::size_t i = IntervalOf(*this, time);
  const double s = (time - times[i]) / (times[i + 1] - times[i]);
  const double weight = interpolation == Interpolation::kSmooth ? s * s * (3 - 2 * s) : s;
  return values[i] + weight * (values[i + 1] - values[i]);
}

double Curve::RateAt(double time) const {
  if (time < times.front() || time >= times.back()) return 0;
  const std::size_t i = IntervalOf(*this, time);
  const double interval = times[i + 1] - times[i];
  const double slope = (values[i + 1] - values[i]) / interval;
  if (interpolation == Interpolation::kLinear) return slope;
  const double s = (time - times[i]) / interval;
  return 6 * s * (1 - s) * slope;
}

}  // namespace fascicle
