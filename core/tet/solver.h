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
  // Curvature of the energy along this step's motion times dt^2: a Rayleigh quotient of M^-1 K. The central difference
  // method is unstable if it stays above 4.
  double stiffness_of_motion = 0;
  BadElements bad;  // where a step failed
};

// Steps a model in time by Lagrangian finite volumes [Teran 2003]. Not thread-safe.
class TetSolver {
 public:
  // Model, team and profile must outlive the solver. Stages of a step are timed in `profile`, which may be null.
  TetSolver(const TetModel& model, ThreadTeam& team, Profile* profile = nullptr);

  // The state at time 0: at rest, with prescribed components at their values.
  TetState InitialState();

  // Makes one step towards `end` [s], which it never passes and hits exactly. A step that inverts or crushes an
  // element, gives non-finite values or gains energy from instability is repeated with half the length, up to kMaxCuts
  // times. Implicit and quasi-static steps are as long as Newton's method allows: the first attempt goes to `end`; the
  // length is halved when the iteration fails and doubled after an easy step. If a step fails, the state keeps its time
  // and motion. Newton iterations end early when `stop` requests it.
  StepReport Advance(TetState& state, double end, std::stop_token stop = {});

  // One attempt to step from `now` to `next_time`, without repetition. Sets all of `next` except for what Advance
  // manages.
  StepReport Step(const TetState& now, double next_time, TetState& next);

  // The largest stable step at a state [s], see LargestStableStep.
  double StableStepAt(const TetState& state);

  static constexpr int kMaxCuts = 10;

 private:
  // Central difference method in kick-drift-kick form; viscous forces use the velocity of the half step.
  StepReport StepExplicit(const TetState& now, double dt, TetState& next);
  // Explicit elastic forces, implicit damping [Teran 2003, 4.3].
  StepReport StepMixed(const TetState& now, double dt, TetState& next);

  // Steppings that solve for the end of the step: implicit_step.cc.
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
  // Computes the quantities that detect an unstable step; next.velocities are those of the half step.
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
  // Scratch memory: nothing here outlives a step.
  std::stop_token stop_;
  TetControls controls_now_, controls_next_;
  NodalVector external_now_, external_next_;
  NodalVector right_side_, inverse_diagonal_;
  ForceWorkspace forces_;
  CgWorkspace cg_;
  StableStepWorkspace stable_step_;
  std::unique_ptr<NewtonSolver> newton_;  // for implicit steppings
  IncrementalPotential potential_;
  TetState next_;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_SOLVER_H_
