#ifndef FASCICLE_CORE_EULERIAN_WORLD_H_
#define FASCICLE_CORE_EULERIAN_WORLD_H_

#include <vector>

#include "core/eulerian/contact.h"

namespace fascicle {

// The outcome of a step.
struct EulerianReport {
  StepProblem problem = StepProblem::kNone;
  BadElements bad;  // the cells of a body's grid at which it failed
  // Of the program of volumes and supports, relative as its tolerance; negative if there was none [1].
  double residual = -1;
};

// Steps solids on their grids together, with a common time step [Fan 2013, algorithm 1]: forces; advection of
// velocities; volumes, supports and contacts in programs of all bodies that touch; advection of the reference maps and
// their extrapolation to a band around the solids; the surfaces; plastic flow. Not thread-safe. The same bits for any
// number of threads, and for a state that was saved and loaded. All functions may throw Stopped (core/base/stop.h);
// states are then unchanged.
class EulerianWorld {
 public:
  // Scene, bodies (one for each of the scene's) and team must outlive this, as must the profile, which may be null.
  EulerianWorld(const Scene& scene, const std::vector<const EulerianBody*>& bodies, ThreadTeam& team,
                Profile* profile = nullptr);

  // The rest state at time 0.
  EulerianWorldState InitialState() const;

  // The next step from `state` with the controls at its time: the longest one that is stable for all bodies and does
  // not pass `end` [s], which is hit exactly. The last two steps before `end` have equal length. Problems:
  // kInvertedElement (a map folds), kLeftGrid, kStepTooSmall.
  StepProposal ProposeStep(const EulerianWorldState& state, const Controls& now, double end);

  // Steps by dt [s] to the time of `next`; dt must not exceed that of the last ProposeStep, which must have been called
  // with the same state and controls. On a problem the state is unchanged: kInvertedElement, kVelocitiesNotFound
  // (MINRES, or which contacts hold), kNotFinite.
  EulerianReport Step(EulerianWorldState& state, const Controls& now, const Controls& next, double dt);

  const BodyStepper& body(std::size_t body) const { return steppers_[body]; }
  // Those of the state of the last ProposeStep.
  const EulerianContacts& contacts() const { return contacts_; }

 private:
  // The controls of each body.
  std::vector<BodyControls> ControlsOfBodies(const Controls& controls) const;
  StepProblem FindVelocities(const EulerianWorldState& state, const std::vector<BodyControls>& now, double dt,
                             int& iterations, double& residual);
  std::vector<ContactRow> ContactRowsFor(double dt);
  StepProblem SolveProgram(const std::vector<std::size_t>& bodies, const std::vector<ContactRow>& rows,
                           const EulerianWorldState& state, const std::vector<BodyControls>& now, double dt,
                           int& iterations, double& residual);

  const Scene& scene_;
  ThreadTeam& team_;
  Profile* const profile_;
  std::vector<BodyStepper> steppers_;
  EulerianContacts contacts_;
  std::vector<Vec3> floor_impulses_;  // in the current step [N s]
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_WORLD_H_
