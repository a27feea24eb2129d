#ifndef FASCICLE_TESTS_SUPPORT_STATIC_RUN_H_
#define FASCICLE_TESTS_SUPPORT_STATIC_RUN_H_

#include "tests/support/tet_scenes.h"
#include "tests/support/tet_stepper.h"

namespace fascicle::testing {

// Steps a scene directly.
struct SteppedRun {
  explicit SteppedRun(Scene s, int threads = 1)
      : scene(std::move(s)), model(scene), team(threads), solver(model, team), state(solver.InitialState()) {}

  // Steps to `end` [s]; false on a problem.
  bool To(double end) {
    while (state.time < end) {
      if (solver.Advance(state, end).problem != StepProblem::kNone) return false;
    }
    return true;
  }

  std::size_t FreeComponents() const {
    std::size_t free = 0;
    for (const Vec3& m : model.inverse_mass()) free += (m.array() != 0).count();
    return free;
  }
  // The mesh or mid-edge node at rest position X.
  std::size_t NodeAt(const Vec3& X) const {
    std::size_t best = 0;
    for (std::size_t n = 0; n < model.nodes(); ++n) {
      if ((model.rest_positions()[n] - X).norm() < (model.rest_positions()[best] - X).norm()) best = n;
    }
    return best;
  }
  Vec3 Displacement(std::size_t node) const { return state.positions[node] - model.rest_positions()[node]; }
  Vec3 DisplacementAt(const Vec3& X) const { return Displacement(NodeAt(X)); }
  // Force of a support on the body [N].
  Vec3 Reaction(std::size_t support) { return solver.Reactions(state).at(support); }

  const Scene scene;
  const TetModel model;
  ThreadTeam team;
  TetStepper solver;
  TetState state;
};

// Increases from 0 at 0 s to `value` at 1 s.
inline Curve Ramp(double value) { return {{0, 1}, {0, value}, Curve::Interpolation::kLinear}; }

// A scene of one second without inertia; all settings except the element have their defaults.
inline Scene StaticScene(Body body, ElementOrder element) {
  Scene scene = OneBody(std::move(body));
  scene.output.frame_interval = 1;
  scene.tet.stepping = Stepping::kQuasiStatic;
  scene.tet.element = element;
  return scene;
}

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_SUPPORT_STATIC_RUN_H_
