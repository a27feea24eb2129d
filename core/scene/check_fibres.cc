#include <algorithm>
#include <cmath>

#include "core/scene/checks.h"

namespace fascicle::scene_checks {
namespace {

void CheckBody(const Body& body, const std::string& path, Problems& problems) {
  const auto needs = [](const Material& material) {
    return std::visit([](const auto& law) { return law.kNeedsFibres; }, material);
  };
  const bool needed =
      needs(body.material) || std::any_of(body.more_materials.begin(), body.more_materials.end(), needs);
  if (body.fibres.empty()) {
    if (needed) {
      problems.Add(path, "this material needs fibre directions",
                   "give constant, file, harmonic or bspline fibres, or choose an isotropic material");
    }
    return;
  }
  // A surface without tetrahedra has one direction.
  const bool one = body.elements() == 0 && !body.surface.triangles.empty();
  if (body.fibres.size() != (one ? 1 : body.elements())) {
    problems.Add(path, std::to_string(body.fibres.size()) + " fibre directions for " + std::to_string(body.elements()) +
                           " tetrahedra");
    return;
  }
  for (std::size_t e = 0; e < body.fibres.size(); ++e) {
    // Rounding leaves unit vectors within some 1e-16 of length 1; 1e-6 also lets through those kept in float.
    if (std::abs(body.fibres[e].norm() - 1) < 1e-6) continue;
    problems.Add(path, "the fibre direction of tetrahedron " + std::to_string(e) + " is not a unit vector");
    return;
  }
}

}  // namespace

void CheckFibres(const Scene& scene, Problems& problems) {
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    CheckBody(scene.bodies[i], JoinPath(IndexPath("bodies", i), "fibres"), problems);
  }
}

}  // namespace fascicle::scene_checks
