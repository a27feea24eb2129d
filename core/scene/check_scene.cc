#include "core/base/stop.h"
#include "core/scene/checks.h"

namespace fascicle {

void CheckScene(const Scene& scene, Problems& problems, const std::stop_token& stop) {
  using namespace scene_checks;  // NOLINT(google-build-using-namespace): all of them
  for (const auto check : {CheckBodies, CheckCurves, CheckMaterials, CheckActivations, CheckInitialState, CheckFibres,
                           CheckConstraints, CheckLoads, CheckFloors, CheckRigidBodies, CheckContacts, CheckSkeleton,
                           CheckTet, CheckVoxel, CheckEulerian, CheckOutput}) {
    ThrowIfStopped(stop);
    check(scene, problems);
  }
  ThrowIfStopped(stop);
  // Adds up loads over curves, so the curves must be valid.
  if (problems.empty()) CheckSupports(scene, problems);
}

}  // namespace fascicle
