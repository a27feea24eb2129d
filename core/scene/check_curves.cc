#include <algorithm>
#include <cmath>

#include "core/scene/checks.h"

namespace fascicle::scene_checks {
namespace {

bool AllFinite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
}

// Whether it can be evaluated.
bool CheckCurve(const Curve& curve, const std::string& path, Problems& problems) {
  const std::size_t before = problems.count();
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
  return problems.count() == before;
}

void CheckMotion(const Motion& motion, const std::string& path, Problems& problems) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (motion.translation[axis]) {
      CheckCurve(*motion.translation[axis], JoinPath(path, IndexPath("translation", axis)), problems);
    }
  }
  if (motion.rotation) CheckCurve(motion.rotation->angle, JoinPath(path, "rotation.angle"), problems);
}

void CheckActivation(const Curve& curve, const std::string& path, Problems& problems) {
  if (!CheckCurve(curve, path, problems)) return;
  // Both interpolations stay between the values of neighbouring points.
  const auto [low, high] = std::minmax_element(curve.values.begin(), curve.values.end());
  if (*low < 0 || *high > 1) {
    problems.Add(JoinPath(path, "values"), "activation must stay within [0, 1]",
                 "it is a fraction of the full activation, not a percentage");
  }
}

}  // namespace

void CheckCurves(const Scene& scene, Problems& problems) {
  CheckCurve(scene.gravity.scale, "gravity.scale", problems);
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    const std::string path = IndexPath("bodies", i);
    CheckActivation(body.activation, JoinPath(path, "activation"), problems);
    for (std::size_t k = 0; k < body.more_activations.size(); ++k) {
      CheckActivation(body.more_activations[k], JoinPath(path, JoinPath(IndexPath("region_activations", k), "curve")),
                      problems);
    }
    for (std::size_t k = 0; k < body.constraints.size(); ++k) {
      CheckMotion(body.constraints[k].motion, JoinPath(path, JoinPath(IndexPath("constraints", k), "motion")),
                  problems);
    }
    for (std::size_t k = 0; k < body.loads.size(); ++k) {
      CheckCurve(body.loads[k].scale, JoinPath(path, JoinPath(IndexPath("loads", k), "scale")), problems);
    }
  }
}

}  // namespace fascicle::scene_checks
