#include <algorithm>

#include "core/geometry/mesh_edges.h"
#include "core/scene/checks.h"

namespace fascicle::scene_checks {
namespace {

// A value for each node of the mesh, or with quadratic elements for each node that they have.
void CheckValues(const Scene& scene, const TetMesh& mesh, const std::vector<Vec3>& values, const char* what,
                 const std::string& path, Problems& problems) {
  if (values.empty()) return;
  const std::size_t nodes = mesh.nodes.size();
  const bool quadratic = scene.tet.element == ElementOrder::kQuadratic;
  std::string expected = std::to_string(nodes) + " nodes";
  bool fits = values.size() == nodes;
  if (!fits && quadratic) {
    const std::size_t all = nodes + NumberEdges(mesh).ends.size();
    fits = values.size() == all;
    expected += ", or " + std::to_string(all) + " with mid-edge nodes";
  }
  if (!fits) problems.Add(path, std::to_string(values.size()) + " " + what + " for " + expected);
  const auto wrong = std::find_if(values.begin(), values.end(), [](const Vec3& x) { return !x.allFinite(); });
  if (wrong != values.end()) {
    problems.Add(path, "the value of node " + std::to_string(wrong - values.begin()) + " is not finite");
  }
}

}  // namespace

void CheckInitialState(const Scene& scene, Problems& problems) {
  if (scene.method != Method::kTet && (scene.start.equilibrium || scene.start.frame)) {
    problems.Add(
        "start",
        std::string("the ") + kMethodNames[static_cast<std::size_t>(scene.method)] + " method does not support it",
        scene.method == Method::kVoxel ? "`voxel.start_loaded` begins in equilibrium" : "omit it");
  }
  if (scene.start.equilibrium && scene.tet.precision == Precision::kSingle) {
    problems.Add("start.equilibrium", "needs double precision", "omit `tet.precision`");
  }
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const auto* tet = std::get_if<TetShape>(&scene.bodies[i].shape);
    if (tet == nullptr) continue;
    const std::string path = IndexPath("bodies", i);
    CheckValues(scene, tet->mesh, tet->initial_displacement, "displacements", JoinPath(path, "initial_displacement"),
                problems);
    CheckValues(scene, tet->mesh, tet->initial_velocity, "velocities", JoinPath(path, "initial_velocity"), problems);
  }
}

}  // namespace fascicle::scene_checks
