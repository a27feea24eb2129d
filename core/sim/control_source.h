#ifndef FASCICLE_CORE_SIM_CONTROL_SOURCE_H_
#define FASCICLE_CORE_SIM_CONTROL_SOURCE_H_

#include "core/scene/controls.h"

namespace fascicle {

// Evaluates the curves of a scene. Not thread-safe.
class ControlSource {
 public:
  // The scene must have passed CheckScene and must outlive the source.
  explicit ControlSource(const Scene& scene) : scene_(&scene) {}

  // Sets all controls to their values at a time [s]. Does not allocate if `controls` already has the scene's sizes.
  void Evaluate(double time, Controls& controls);
  Controls At(double time);

 private:
  const Scene* scene_;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_SIM_CONTROL_SOURCE_H_
