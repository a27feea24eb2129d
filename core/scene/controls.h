#ifndef FASCICLE_CORE_SCENE_CONTROLS_H_
#define FASCICLE_CORE_SCENE_CONTROLS_H_

#include <span>
#include <vector>

#include "core/scene/rigid_motion.h"
#include "core/scene/scene.h"

namespace fascicle {

// What acts on a scene at one time, as plain data. Whoever steps a method supplies it: from the scene's curves
// (core/sim/control_source.h), or by setting any number of it before the step. Arrays hold the values of all bodies,
// one body after the other in the scene's order.
struct Controls {
  double time = 0;                         // [s]
  std::vector<double> activations;         // of each body: its own, then those of its parts; in [0, 1]
  std::vector<double> load_scales;         // of each load [1]
  std::vector<RigidMotion> motions;        // of each constraint
  double gravity_scale = 1;                // of Gravity::acceleration [1]
  std::vector<double> force_field_scales;  // of each plane force field of the scene [1]
};

// The part of a scene's controls that acts on one body. Views: the controls must outlive it.
struct BodyControls {
  std::span<const double> activations, load_scales;
  std::span<const RigidMotion> motions;
  double gravity_scale = 1;
  std::span<const double> force_field_scales;
};

// body: an index into scene.bodies; the sizes of `controls` must be those of the scene.
BodyControls ControlsOf(const Scene& scene, std::size_t body, const Controls& controls);

}  // namespace fascicle

#endif  // FASCICLE_CORE_SCENE_CONTROLS_H_
