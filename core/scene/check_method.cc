#include "core/scene/checks.h"

namespace fascicle::scene_checks {

void CheckMethod(const Scene& scene, Problems& problems) {
  const TetMethod& method = scene.method;
  if (method.precision == Precision::kSingle && method.stepping != Stepping::kExplicit &&
      method.stepping != Stepping::kMixed) {
    problems.Add("tet.precision", "steps that are solved for need double precision",
                 "leave it off, or take explicit or mixed stepping");
  }
}

}  // namespace fascicle::scene_checks
