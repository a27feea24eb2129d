#include "core/scene/checks.h"

namespace fascicle::scene_checks {

void CheckTet(const Scene& scene, Problems& problems) {
  if (scene.method != Method::kTet) return;
  const TetMethod& method = scene.tet;
  if (method.precision == Precision::kSingle && method.stepping != Stepping::kExplicit &&
      method.stepping != Stepping::kMixed) {
    problems.Add("tet.precision", "implicit steps need double precision", "omit it, or use explicit or mixed stepping");
  }
}

}  // namespace fascicle::scene_checks
