#include "server/translate/curves.h"

#include <cmath>

#include "server/translate/values.h"

namespace fascicle::server {
namespace {

constexpr int kMaxPoints = 10'000;
constexpr int kMaxReported = 5;  // reported values of one curve

void CheckTimes(const v1::Curve& curve, const std::string& path, Problems& problems) {
  if (curve.times_size() > kMaxPoints) {
    problems.Add(JoinPath(path, "times"), "has " + std::to_string(curve.times_size()) + " points", "at most 10,000");
  }
  for (int i = 1; i < curve.times_size(); ++i) {
    if (!(curve.times(i) <= curve.times(i - 1))) continue;
    problems.Add(JoinPath(path, IndexPath("times", static_cast<std::size_t>(i))),
                 "is " + Text(curve.times(i)) + " s after " + Text(curve.times(i - 1)) + " s",
                 "times must increase strictly; for a jump, use two close points");
    return;
  }
}

void CheckValues(const v1::Curve& curve, const CurveUse& use, const std::string& path, Problems& problems) {
  if (curve.values_size() != curve.times_size()) {
    problems.Add(
        JoinPath(path, "values"),
        "has " + std::to_string(curve.values_size()) + " values for " + std::to_string(curve.times_size()) + " times",
        "one value for each time");
  }
  int wrong = 0;
  for (int i = 0; i < curve.values_size(); ++i) {
    const double value = curve.values(i);
    // Values that are not finite are reported by the rules.
    if (!std::isfinite(value) || (value >= use.min && value <= use.max)) continue;
    if (++wrong > kMaxReported) return;
    problems.Add(JoinPath(path, IndexPath("values", static_cast<std::size_t>(i))),
                 "is " + Text(value) + ", outside the range [" + Text(use.min) + ", " + Text(use.max) + "]",
                 std::string("unit ") + use.unit);
  }
}

}  // namespace

Curve::Interpolation InterpolationOf(v1::Interpolation interpolation) {
  return interpolation == v1::INTERPOLATION_SMOOTH ? Curve::Interpolation::kSmooth : Curve::Interpolation::kLinear;
}

Curve TranslateCurve(const v1::Curve& curve, const CurveUse& use, const std::string& path, Problems& problems) {
  Problems own;
  CheckTimes(curve, path, own);
  CheckValues(curve, use, path, own);
  problems.Append("", own);
  if (!own.empty() || !ObeysRules(curve)) return Curve::Constant(use.neutral);
  Curve result;
  result.times.assign(curve.times().begin(), curve.times().end());
  result.values.assign(curve.values().begin(), curve.values().end());
  result.interpolation = InterpolationOf(curve.interpolation());
  return result;
}

}  // namespace fascicle::server
