#ifndef FASCICLE_CORE_SIM_CONTROL_SOURCE_H_
#define FASCICLE_CORE_SIM_CONTROL_SOURCE_H_

#include "core/scene/controls.h"

namespace fascicle {

// The controls that a scene's curves ask for. Not thread-safe.
class ControlSource {
 public:
  // The scene must have passed CheckScene and must outlive the source.
  explicit ControlSource(const Scene& scene) : scene_(&scene) {}

  // Sets all controls to those of a time [s]. Allocates nothing where `controls` has held those of the scene before.
  void Evaluate(double time, Controls& controls);
  Controls At(double time);

 private:
  const Scene* scene_;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_SIM_CONTROL_SOURCE_H_
