#include "core/sim/method_run.h"

#include "core/base/check.h"
#include "core/sim/bodiless_run.h"
#include "core/sim/eulerian_run.h"
#include "core/sim/tet_run.h"
#include "core/sim/voxel_run.h"

namespace fascicle {

std::unique_ptr<MethodRun> MakeMethodRun(const Scene& scene, ThreadTeam& team, Profile* profile) {
  if (scene.bodies.empty()) return MakeBodilessRun();
  switch (scene.method) {
    case Method::kEulerian:
      return MakeEulerianRun(scene, team, profile);
    case Method::kVoxel:
      return MakeVoxelRun(scene, team, profile);
    case Method::kTet:
      return MakeTetRun(scene, team, profile);
  }
  return nullptr;
}

}  // namespace fascicle
