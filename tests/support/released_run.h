#ifndef FASCICLE_TESTS_SUPPORT_RELEASED_RUN_H_
#define FASCICLE_TESTS_SUPPORT_RELEASED_RUN_H_

#include "core/tet/floor_contact.h"
#include "tests/support/static_run.h"

// Bodies released from a static equilibrium.
namespace fascicle::testing {

// Lets a run move on from `positions` at rest, with the acceleration of its forces.
inline void StartAtRest(SteppedRun& run, const NodalVector& positions, const std::vector<double>& pressures) {
  TetState& state = run.state;
  state.positions = positions;
  state.pressures = pressures;
  ForceWorkspace workspace;
  const std::vector<double> activations = ControlSource(run.scene).At(0).activations;
  ElasticForce(run.model, FibreDrive{activations}, positions, run.team, workspace, state.force);
  if (run.scene.tet.stepping != Stepping::kNewmark) return;
  for (std::size_t n = 0; n < run.model.nodes(); ++n) {
    state.accelerations[n] = run.model.inverse_mass()[n].cwiseProduct(state.force[n]);
    state.force[n] = run.model.mass()[n] * state.accelerations[n];
  }
}

// The scene without its loads, at rest in the equilibrium that it has with them at one second. Gravity and floors, if
// there are any, act on the motion only.
struct ReleasedRun : SteppedRun {
  ReleasedRun(const Scene& loaded, Stepping stepping, double time_step)
      : SteppedRun(Moving(loaded, stepping, time_step)) {
    Scene still = loaded;
    still.tet.stepping = Stepping::kQuasiStatic;
    still.tet.time_step.reset();
    still.gravity.acceleration.setZero();
    still.floors.clear();
    SteppedRun equilibrium(still);
    is_in_equilibrium = equilibrium.To(1);
    StartAtRest(*this, equilibrium.state.positions, equilibrium.state.pressures);
  }

  // Elastic, kinetic and contact energy, less the work of gravity [J].
  double Energy() {
    double sum = KineticEnergy(model, state.velocities, team) + FloorEnergy(model, state.positions);
    const std::vector<double> activations = ControlSource(scene).At(state.time).activations;
    for (std::size_t b = 0; b < model.bodies().size(); ++b) {
      sum += ElasticEnergy(model, b, FibreDrive{activations}, state.positions, team);
    }
    return sum - state.external_work;
  }

  bool is_in_equilibrium = false;

 private:
  static Scene Moving(Scene scene, Stepping stepping, double time_step) {
    scene.tet.stepping = stepping;
    if (stepping != Stepping::kExplicit) scene.tet.time_step = time_step;
    for (Body& body : scene.bodies) body.loads.clear();
    scene.duration = 1000;
    return scene;
  }
};

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_SUPPORT_RELEASED_RUN_H_
