#include <algorithm>

#include "core/scene/checks.h"

namespace fascicle::scene_checks {
namespace {

bool IsViscoelastic(const Body& body) {
  const auto has_terms = [](const PronySeries& series) { return !series.terms.empty(); };
  const auto* tet = std::get_if<TetShape>(&body.shape);
  return has_terms(body.viscoelasticity) ||
         (tet != nullptr && std::any_of(tet->viscoelasticity.begin(), tet->viscoelasticity.end(), has_terms));
}

}  // namespace

void CheckTet(const Scene& scene, Problems& problems) {
  if (scene.method != Method::kTet) return;
  const TetMethod& method = scene.tet;
  if (method.precision == Precision::kSingle && method.stepping != Stepping::kExplicit &&
      method.stepping != Stepping::kMixed) {
    problems.Add("tet.precision", "implicit steps need double precision", "omit it, or use explicit or mixed stepping");
  }
  if (method.precision == Precision::kSingle && std::any_of(scene.bodies.begin(), scene.bodies.end(), IsViscoelastic)) {
    problems.Add("tet.precision", "viscoelastic materials need double precision", "omit it");
  }
}

}  // namespace fascicle::scene_checks
