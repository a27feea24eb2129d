#ifndef FASCICLE_CORE_EULERIAN_WORLD_H_
#define FASCICLE_CORE_EULERIAN_WORLD_H_

#include <vector>

#include "core/eulerian/body_stepper.h"

namespace fascicle {

// How a step ended.
struct EulerianReport {
  StepProblem problem = StepProblem::kNone;
  BadElements bad;  // cells of the grid of a body, where it could not be made
};

// Steps solids on their grids together, all by the same time [Fan 2013, algorithm 1]: forces; velocities advected;
// volumes and supports in one program of all bodies; the reference maps advected and continued into a band around the
// solids; the surfaces; plastic flow. Not thread-safe; the same bits for any number of threads, and of a state
// that was saved and loaded. All may end early by Stopped (core/base/stop.h); states are then as they were.
class EulerianWorld {
 public:
  // Scene, bodies (one for each of the scene's) and team must outlive it, and so must the profile, where stages are
  // timed if there is one.
  EulerianWorld(const Scene& scene, const std::vector<const EulerianBody*>& bodies, ThreadTeam& team,
                Profile* profile = nullptr);

  // At rest at time 0.
  EulerianWorldState InitialState() const;

  // The next step from `state`, under the controls at its time, towards `end` [s], which it never passes and hits
  // exactly: as long as is stable for all bodies; the last two before `end` are equal. Problems: kInvertedElement (a
  // map folds), kLeftGrid, kStepTooSmall.
  StepProposal ProposeStep(const EulerianWorldState& state, const Controls& now, double end);

  // Makes a step of dt [s] to the time of `next`, no longer than the last ProposeStep said, which must have been for
  // the same state and controls. On a problem the state stays as it was: kInvertedElement, kVelocitiesNotFound
  // (MINRES), kNotFinite.
  EulerianReport Step(EulerianWorldState& state, const Controls& now, const Controls& next, double dt);

  const BodyStepper& body(std::size_t body) const { return steppers_[body]; }

 private:
  // Of each body.
  std::vector<BodyControls> ControlsOfBodies(const Controls& controls) const;
  StepProblem FindVelocities(const EulerianWorldState& state, const std::vector<BodyControls>& now, double dt,
                             int& iterations);

  const Scene& scene_;
  ThreadTeam& team_;
  Profile* const profile_;
  std::vector<BodyStepper> steppers_;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_WORLD_H_
