#include <algorithm>

#include "core/scene/checks.h"

namespace fascicle::scene_checks {

void CheckPartNumbers(const std::vector<std::int32_t>& parts, std::size_t elements, std::size_t others,
                      const std::string& path, Problems& problems) {
  if (parts.empty()) return;
  if (parts.size() != elements) {
    problems.Add(path, std::to_string(parts.size()) + " entries for " + std::to_string(elements) + " elements");
  }
  const auto wrong = std::find_if(parts.begin(), parts.end(), [&](std::int32_t part) {
    return part < 0 || static_cast<std::size_t>(part) > others;
  });
  if (wrong != parts.end()) {
    problems.Add(path, "element " + std::to_string(wrong - parts.begin()) + " asks for number " +
                           std::to_string(*wrong) + " of " + std::to_string(others));
  }
}

void CheckMaterials(const Scene& scene, Problems& problems) {
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    CheckPartNumbers(body.material_of, body.elements(), body.more_materials.size(),
                     JoinPath(IndexPath("bodies", i), "region_materials"), problems);
  }
}

}  // namespace fascicle::scene_checks
