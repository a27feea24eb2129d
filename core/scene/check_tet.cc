#include "core/scene/checks.h"

namespace fascicle::scene_checks {
namespace {

// Hexahedral elements need hexahedra; other elements need meshes whose values are those of tetrahedra.
void CheckElements(const Scene& scene, Problems& problems) {
  const bool wanted = scene.tet.element == ElementOrder::kHexahedral;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const auto* shape = std::get_if<TetShape>(&scene.bodies[i].shape);
    if (shape == nullptr || shape->mesh.tetrahedra.empty() || shape->mesh.hexahedra.empty() != wanted) continue;
    const std::string path = JoinPath(IndexPath("bodies", i), "mesh");
    if (wanted) {
      problems.Add(path, "has tetrahedra, but the scene's elements are hexahedral",
                   "give a mesh of hexahedra, or omit `tet.element`");
    } else {
      problems.Add(path, "has hexahedra, but the scene's elements are tetrahedra", "set `tet.element` to HEXAHEDRAL");
    }
  }
}

}  // namespace

void CheckTet(const Scene& scene, Problems& problems) {
  if (scene.method != Method::kTet) return;
  const TetMethod& method = scene.tet;
  CheckElements(scene, problems);
  if (method.precision == Precision::kSingle && method.stepping != Stepping::kExplicit &&
      method.stepping != Stepping::kMixed) {
    problems.Add("tet.precision", "implicit steps need double precision", "omit it, or use explicit or mixed stepping");
  }
}

}  // namespace fascicle::scene_checks
