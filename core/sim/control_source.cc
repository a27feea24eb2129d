#include "core/sim/control_source.h"

namespace fascicle {

void ControlSource::Evaluate(double time, Controls& controls) {
  controls.time = time;
  controls.gravity_scale = scene_->gravity.scale.At(time);
  controls.force_field_scales.clear();
  for (const PlaneForceField& field : scene_->squeezes) controls.force_field_scales.push_back(field.scale.At(time));
  controls.activations.clear();
  controls.load_scales.clear();
  controls.motions.clear();
  for (const Body& body : scene_->bodies) {
    controls.activations.push_back(body.activation.At(time));
    if (const auto* shape = std::get_if<TetShape>(&body.shape)) {
      for (const Curve& activation : shape->activations.more) controls.activations.push_back(activation.At(time));
    }
    for (const Load& load : body.loads) controls.load_scales.push_back(load.scale.At(time));
    for (const Constraint& constraint : body.constraints) controls.motions.push_back(MotionAt(constraint.motion, time));
  }
}

Controls ControlSource::At(double time) {
  Controls controls;
  Evaluate(time, controls);
  return controls;
}

}  // namespace fascicle
