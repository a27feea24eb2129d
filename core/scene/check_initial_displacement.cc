#include <algorithm>

#include "core/scene/checks.h"

namespace fascicle::scene_checks {

void CheckInitialDisplacement(const Scene& scene, Problems& problems) {
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const auto* tet = std::get_if<TetShape>(&scene.bodies[i].shape);
    if (tet == nullptr || tet->initial_displacement.empty()) continue;
    const std::vector<Vec3>& u = tet->initial_displacement;
    const std::string path = JoinPath(IndexPath("bodies", i), "initial_displacement");
    if (u.size() != tet->mesh.nodes.size()) {
      problems.Add(
          path, std::to_string(u.size()) + " displacements for " + std::to_string(tet->mesh.nodes.size()) + " nodes");
    }
    const auto wrong = std::find_if(u.begin(), u.end(), [](const Vec3& x) { return !x.allFinite(); });
    if (wrong != u.end())
      problems.Add(path, "the value of node " + std::to_string(wrong - u.begin()) + " is not finite");
  }
}

}  // namespace fascicle::scene_checks
