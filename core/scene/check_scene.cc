#include "core/scene/checks.h"

namespace fascicle {

void CheckScene(const Scene& scene, Problems& problems) {
  scene_checks::CheckBodies(scene, problems);
  scene_checks::CheckCurves(scene, problems);
  scene_checks::CheckMaterials(scene, problems);
  scene_checks::CheckActivations(scene, problems);
  scene_checks::CheckInitialDisplacement(scene, problems);
  scene_checks::CheckFibres(scene, problems);
  scene_checks::CheckConstraints(scene, problems);
  scene_checks::CheckLoads(scene, problems);
  scene_checks::CheckFloors(scene, problems);
  scene_checks::CheckTet(scene, problems);
  scene_checks::CheckVoxel(scene, problems);
  scene_checks::CheckEulerian(scene, problems);
  scene_checks::CheckOutput(scene, problems);
  // Adds up loads over curves, so the curves must be valid.
  if (problems.empty()) scene_checks::CheckSupports(scene, problems);
}

}  // namespace fascicle
