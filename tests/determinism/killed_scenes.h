#ifndef FASCICLE_TESTS_DETERMINISM_KILLED_SCENES_H_
#define FASCICLE_TESTS_DETERMINISM_KILLED_SCENES_H_

#include <stdexcept>
#include <string>
#include <vector>

#include "small_scenes.h"

namespace fascicle::testing {

// The small scenes, and the treatments of volume that these lack.
inline std::vector<NamedScene> KilledScenes() {
  std::vector<NamedScene> scenes = SmallScenes();
  for (const bool is_implicit : {false, true}) {
    const std::string kind = is_implicit ? "implicit_" : "explicit_";
    scenes.push_back(EulerianSceneOf(kind + "divergence_free", VolumeTreatment::kDivergenceFree, is_implicit));
  }
  scenes.push_back(EulerianSceneOf("implicit_none", VolumeTreatment::kNone, true));
  return scenes;
}

inline Scene KilledScene(const std::string& name) {
  for (NamedScene& named : KilledScenes()) {
    if (named.name == name) return std::move(named.scene);
  }
  throw std::runtime_error("no scene " + name);
}

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_DETERMINISM_KILLED_SCENES_H_
