#ifndef FASCICLE_CORE_SCENE_CONTROLS_H_
#define FASCICLE_CORE_SCENE_CONTROLS_H_

#include <span>
#include <vector>

#include "core/scene/rigid_motion.h"
#include "core/scene/scene.h"

namespace fascicle {

// Everything that acts on a scene at one time, as plain data. The caller of a method provides it, from the scene's
// curves (core/sim/control_source.h) or by setting any value before a step. Arrays contain the values of all bodies,
// one body after the other in the scene's order.
struct Controls {
  double time = 0;                         // [s]
  std::vector<double> activations;         // for each body: its own, then those of its parts; in [0, 1]
  std::vector<double> load_scales;         // for each load [1]
  std::vector<RigidMotion> motions;        // for each constraint
  std::vector<RigidMotion> rigid_motions;  // for each rigid body of the scene, from its pose at time 0
  double gravity_scale = 1;                // factor on Gravity::acceleration [1]
  std::vector<double> force_field_scales;  // for each plane force field of the scene [1]
};

// The controls of one body, as views into those of a scene, which must outlive it.
struct BodyControls {
  std::span<const double> activations, load_scales;
  std::span<const RigidMotion> motions;
  double gravity_scale = 1;
  std::span<const double> force_field_scales;
};

// body: index into scene.bodies. `controls` must have the sizes of the scene.
BodyControls ControlsOf(const Scene& scene, std::size_t body, const Controls& controls);

}  // namespace fascicle

#endif  // FASCICLE_CORE_SCENE_CONTROLS_H_
