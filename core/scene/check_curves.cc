#include <algorithm>
#include <cmath>

#include "core/scene/checks.h"
#include "core/scene/curves.h"

namespace fascicle::scene_checks {
namespace {

bool AllFinite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
}

void CheckCurve(const Curve& curve, const std::string& path, Problems& problems) {
  if (curve.times.empty()) problems.Add(JoinPath(path, "times"), "a curve needs at least one point");
  if (curve.times.size() != curve.values.size()) {
    problems.Add(JoinPath(path, "values"),
                 std::to_string(curve.values.size()) + " values for " + std::to_string(curve.times.size()) + " times");
  }
  if (!AllFinite(curve.times)) problems.Add(JoinPath(path, "times"), "a time is not a finite number");
  if (!AllFinite(curve.values)) problems.Add(JoinPath(path, "values"), "a value is not a finite number");
  const auto fall =
      std::adjacent_find(curve.times.begin(), curve.times.end(), [](double a, double b) { return !(a < b); });
  if (fall != curve.times.end()) {
    problems.Add(JoinPath(path, "times"),
                 "times must increase, but number " + std::to_string(fall - curve.times.begin() + 2) + " does not");
  }
}

}  // namespace

void CheckCurves(const Scene& scene, Problems& problems) {
  VisitCurves(scene, [&](const Curve& curve, const std::string& path) { CheckCurve(curve, path, problems); });
}

}  // namespace fascicle::scene_checks
