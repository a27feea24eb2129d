#include <algorithm>

#include "core/scene/checks.h"

namespace fascicle::scene_checks {
namespace {

void CheckScale(const Body& body, const std::string& path, Problems& problems) {
  const std::vector<double>& scale = body.activation_scale;
  if (scale.empty()) return;
  if (scale.size() != body.elements()) {
    problems.Add(path, std::to_string(scale.size()) + " values for " + std::to_string(body.elements()) + " elements");
  }
  const auto wrong = std::find_if(scale.begin(), scale.end(), [](double s) { return !(s >= 0 && s <= 1); });
  if (wrong != scale.end()) {
    problems.Add(path, "the value of element " + std::to_string(wrong - scale.begin()) + " is outside [0, 1]",
                 "it is the part of the activation that reaches the element");
  }
}

}  // namespace

void CheckActivations(const Scene& scene, Problems& problems) {
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    const std::string path = IndexPath("bodies", i);
    CheckPartNumbers(body.activation_of, body.elements(), body.more_activations.size(),
                     JoinPath(path, "region_activations"), problems);
    CheckScale(body, JoinPath(path, "activation_scale"), problems);
  }
}

}  // namespace fascicle::scene_checks
