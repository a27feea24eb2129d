#include <algorithm>

#include "core/scene/check_parts.h"
#include "core/scene/checks.h"

namespace fascicle::scene_checks {
namespace {

// Both interpolations stay between the values of adjacent points.
void CheckRange(const Curve& curve, const std::string& path, Problems& problems) {
  if (std::none_of(curve.values.begin(), curve.values.end(), [](double value) { return value < 0 || value > 1; })) {
    return;
  }
  problems.Add(JoinPath(path, "values"), "activation must stay within [0, 1]",
               "it is a fraction of the full activation, not a percentage");
}

void CheckScale(const std::vector<double>& scale, std::size_t elements, const std::string& path, Problems& problems) {
  if (scale.empty()) return;
  if (scale.size() != elements) {
    problems.Add(path, std::to_string(scale.size()) + " values for " + std::to_string(elements) + " elements");
  }
  const auto wrong = std::find_if(scale.begin(), scale.end(), [](double s) { return !(s >= 0 && s <= 1); });
  if (wrong != scale.end()) {
    problems.Add(path, "the value of element " + std::to_string(wrong - scale.begin()) + " is outside [0, 1]",
                 "it is a factor on the activation of the element");
  }
}

void CheckTetrahedra(const TetShape& shape, const std::string& path, Problems& problems) {
  const std::size_t elements = ElementCount(shape.mesh);
  const std::string of_regions = JoinPath(path, "region_activations");
  CheckParts(shape.activations, elements, of_regions, problems);
  for (std::size_t k = 0; k < shape.activations.more.size(); ++k) {
    CheckRange(shape.activations.more[k], IndexPath(of_regions, k), problems);
  }
  CheckScale(shape.activation_scale, elements, JoinPath(path, "activation_scale"), problems);
}

}  // namespace

void CheckActivations(const Scene& scene, Problems& problems) {
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    const std::string path = IndexPath("bodies", i);
    CheckRange(body.activation, JoinPath(path, "activation"), problems);
    if (body.excitation) CheckRange(body.excitation->curve, JoinPath(path, "excitation.curve"), problems);
    if (const auto* tet = std::get_if<TetShape>(&body.shape)) CheckTetrahedra(*tet, path, problems);
  }
}

}  // namespace fascicle::scene_checks
