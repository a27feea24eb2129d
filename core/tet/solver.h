#ifndef FASCICLE_CORE_TET_SOLVER_H_
#define FASCICLE_CORE_TET_SOLVER_H_

#include <memory>
#include <stop_token>

#include "core/base/profile.h"
#include "core/base/step_problem.h"
#include "core/linalg/conjugate_gradient.h"
#include "core/tet/bad_elements.h"
#include "core/tet/controls.h"
#include "core/tet/forces.h"
#include "core/tet/newton.h"
#include "core/tet/stable_step.h"
#include "core/tet/state.h"

namespace fascicle {

struct StepReport {
  StepProblem problem = StepProblem::kNone;
  int iterations = 0;   // of linear solves, or of Newton's method
  LinearSolves solves;  // of Newton's method
  // Kinetic energy of the free components at the half step [J].
  double kinetic = 0;
  // Curvature of the energy along the motion of this step times dt^2: a Rayleigh quotient of M^-1 K. The central
  // difference method can't stay above 4.
  double stiffness_of_motion = 0;
  BadElements bad;  // where, when a step can't be made
};

// Steps a model in time by Lagrangian finite volumes [Teran 2003]. One thread at a time.
class TetSolver {
 public:
  // Model, team and profile must outlive the solver. Stages of a step are timed in `profile` where there is one.
  TetSolver(const TetModel& model, ThreadTeam& team, Profile* profile = nullptr);

  // At rest at time 0, with what is prescribed at that time.
  TetState InitialState();

  // Makes one step towards `end` [s], which it never passes and hits exactly. A step that inverts or crushes an
  // element, gives values that are not finite or gains energy from instability is made again with half the length, up
  // to kMaxCuts times. Implicit and quasi-static steps go as far as Newton's method converges: from all the way at
  // first, halved when it does not and doubled when it was easy. On a problem the state keeps its time and motion. Long
  // steps, those of Newton's method, end early when `stop` asks for it.
  StepReport Advance(TetState& state, double end, std::stop_token stop = {});

  // One attempt to step from `now` to `next_time`, without cutting; fills all of `next` but what Advance looks after.
  StepReport Step(const TetState& now, double next_time, TetState& next);

  // The largest stable step at a state [s], see LargestStableStep.
  double StableStepAt(const TetState& state);

  static constexpr int kMaxCuts = 10;

 private:
  // Central difference method in its kick-drift-kick form; viscous forces take the velocity of the half step.
  StepReport StepExplicit(const TetState& now, double dt, TetState& next);
  // Elastic forces explicit, damping implicit [Teran 2003, 4.3].
  StepReport StepMixed(const TetState& now, double dt, TetState& next);

  // Any stepping that solves for the end of the step: implicit_step.cc.
  StepReport StepImplicit(const TetState& now, double dt, TetState& next);
  StepReport AdvanceExplicit(TetState& state, double end);
  StepReport AdvanceImplicit(TetState& state, double end);
  bool IsImplicit() const { return method_.stepping != Stepping::kExplicit && method_.stepping != Stepping::kMixed; }
  void SetFirstAcceleration(TetState& state);
  double SmallestRatio(const NodalVector& x) const;
  FibreDrive DriveOf(const TetState& now, double dt) const;

  void UpdateControls(double now, double next);
  void Drift(const TetState& now, double dt, TetState& next);
  CgResult SolveDamping(const NodalVector& x, const NodalVector& internal, const NodalVector& external,
                        double half_step, TetState& next);
  ForceReport UpdateForce(const NodalVector* viscous_velocity, const FibreDrive& drive, TetState& next);
  // Fills what tells an unstable step from a stable one; next.velocities are those of the half step.
  void MeasureMotion(const TetState& now, const TetState& next, StepReport& report) const;
  void AddExternalWork(const TetState& now, TetState& next) const;

  bool IsStableStepDue(const TetState& state);
  void RefreshStableStep(TetState& state);
  double TargetStep(const TetState& state) const;
  StepProblem Judge(const TetState& now, const TetState& next, const StepReport& report) const;
  void Accept(TetState& state);
  StepReport Fail(const TetState& state, StepReport report) const;

  const TetModel& model_;
  ThreadTeam& team_;
  Profile* const profile_;
  const TetMethod& method_;
  // Scratch: nothing here outlives a step.
  std::stop_token stop_;
  TetControls controls_now_, controls_next_;
  NodalVector external_now_, external_next_;
  NodalVector right_side_, inverse_diagonal_;
  ForceWorkspace forces_;
  CgWorkspace cg_;
  StableStepWorkspace stable_step_;
  std::unique_ptr<NewtonSolver> newton_;  // implicit steppings only
  IncrementalPotential potential_;
  TetState next_;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_SOLVER_H_
