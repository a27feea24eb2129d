#include "core/tet/controls.h"

namespace fascicle {
namespace {

template <class ValueOf>
void Prescribe(const TetModel& model, const Controls& controls, const ValueOf& value_of, NodalVector& values) {
  for (std::size_t s = 0; s < model.supports().size(); ++s) {
    const Support& support = model.supports()[s];
    for (std::size_t i = 0; i < support.nodes.size(); ++i) {
      const std::int32_t n = support.nodes[i];
      const Vec3 value = value_of(controls.motions[s], model.rest_positions()[n]);
      for (int c = 0; c < 3; ++c) {
        if (support.owned[i][c]) values[n][c] = value[c];
      }
    }
  }
}

}  // namespace

void PrescribePositions(const TetModel& model, const Controls& controls, NodalVector& positions) {
  Prescribe(
      model, controls, [](const RigidMotion& motion, const Vec3& X) { return motion.PositionOf(X); }, positions);
}

void PrescribeVelocities(const TetModel& model, const Controls& controls, NodalVector& velocities) {
  Prescribe(
      model, controls, [](const RigidMotion& motion, const Vec3& X) { return motion.VelocityOf(X); }, velocities);
}

void ExternalForce(const TetModel& model, const Controls& controls, ThreadTeam& team, NodalVector& force) {
  const Vec3 gravity = controls.gravity_scale * model.scene().gravity.acceleration;
  force.resize(model.nodes());
  ForNodes(team, model.nodes(), [&](std::size_t n) { force[n] = model.mass()[n] * gravity; });
  for (std::size_t k = 0; k < model.loads().size(); ++k) {
    const NodalLoad& load = model.loads()[k];
    for (std::size_t i = 0; i < load.nodes.size(); ++i)
      force[load.nodes[i]] += controls.load_scales[k] * load.forces[i];
  }
}

}  // namespace fascicle
