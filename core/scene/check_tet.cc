#include "core/scene/checks.h"

namespace fascicle::scene_checks {

void CheckTet(const Scene& scene, Problems& problems) {
  if (scene.method != Method::kTet) return;
  const TetMethod& method = scene.tet;
  if (method.precision == Precision::kSingle && method.stepping != Stepping::kExplicit &&
      method.stepping != Stepping::kMixed) {
    problems.Add("tet.precision", "steps that are solved for need double precision",
                 "leave it off, or take explicit or mixed stepping");
  }
}

}  // namespace fascicle::scene_checks
