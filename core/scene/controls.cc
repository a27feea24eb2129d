#include "core/scene/controls.h"

namespace fascicle {
namespace {

// Its own, and those of its parts.
std::size_t ActivationsOf(const Body& body) {
  const auto* shape = std::get_if<TetShape>(&body.shape);
  return 1 + (shape == nullptr ? 0 : shape->activations.more.size());
}

}  // namespace

BodyControls ControlsOf(const Scene& scene, std::size_t body, const Controls& controls) {
  std::size_t activation = 0, load = 0, motion = 0;
  for (std::size_t b = 0; b < body; ++b) {
    activation += ActivationsOf(scene.bodies[b]);
    load += scene.bodies[b].loads.size();
    motion += scene.bodies[b].constraints.size();
  }
  const Body& own = scene.bodies[body];
  return {std::span(controls.activations).subspan(activation, ActivationsOf(own)),
          std::span(controls.load_scales).subspan(load, own.loads.size()),
          std::span(controls.motions).subspan(motion, own.constraints.size()), controls.gravity_scale,
          controls.force_field_scales};
}

}  // namespace fascicle
