#ifndef FASCICLE_CORE_TET_SOLVER_H_
#define FASCICLE_CORE_TET_SOLVER_H_

#include <memory>

#include "core/base/profile.h"
#include "core/base/step_problem.h"
#include "core/linalg/conjugate_gradient.h"
#include "core/tet/bad_elements.h"
#include "core/tet/branches.h"
#include "core/tet/controls.h"
#include "core/tet/energy_correction.h"
#include "core/tet/forces.h"
#include "core/tet/newton.h"
#include "core/tet/stable_step.h"
#include "core/tet/state.h"
#include "core/tet/step_error.h"
#include "core/tet/step_strain.h"

namespace fascicle {

struct StepReport {
  StepProblem problem = StepProblem::kNone;
  bool try_shorter = false;  // the step failed, and ProposeStep has a shorter one
  int iterations = 0;        // of linear solves, or of Newton's method
  LinearSolves solves;       // of Newton's method
  double residual = -1;      // at its end, relative as its tolerance; negative without it
  // Kinetic energy of the free components at the half step [J].
  double kinetic = 0;
  // Curvature of the energy along this step's motion times dt^2: a Rayleigh quotient of M^-1 K. The central difference
  // method is unstable if it stays above 4.
  double stiffness_of_motion = 0;
  double error = -1;  // of an implicit step whose error is controlled, see step_error.h; otherwise negative
  BadElements bad;    // where a step failed
  StepStrain strain;  // of quasi-static steps
};

// Steps a model in time by Lagrangian finite volumes [Teran 2003]. Not thread-safe. All functions may throw
// Stopped (core/base/stop.h), which leaves states unchanged.
class TetSolver {
 public:
  // Model, team and profile must outlive the solver. Stages of a step are timed in `profile`, which may be null.
  TetSolver(const TetModel& model, ThreadTeam& team, Profile* profile = nullptr);

  // The state at time 0: with the scene's initial displacements and velocities, and prescribed components at their
  // values. start: the controls at time 0.
  TetState InitialState(const Controls& start);

  // Moves a state of time 0 to the equilibrium of the controls, at rest except for prescribed motions, whatever the
  // stepping: Newton's method of a quasi-static step (start_equilibrium.cc). If it finds none, loads, activations and
  // motions grow in shorter parts, down to 1/4096 of them. On a problem the state is the last one in equilibrium.
  StepReport SolveEquilibrium(const Controls& start, TetState& state);

  // The next step from `state`, under the controls at its time, towards `end` [s], which it never passes and hits
  // exactly. Explicit and mixed steps are within the stable step, which is found again when it is due, and half as long
  // after each failed attempt. Implicit and quasi-static steps are as long as Newton's method allows: the first one
  // goes to `end`; the length is halved when the iteration fails and doubled after an easy step. Problems: kNotFinite,
  // kStepTooSmall.
  StepProposal ProposeStep(TetState& state, const Controls& now, double end);

  // Makes a step of dt [s] from the controls `now` to `next` and their time. A step that inverts or crushes an element,
  // gives non-finite values, gains energy from instability or finds no equilibrium leaves time and motion unchanged;
  // try_shorter then says whether ProposeStep has a shorter one (kMaxCuts times for explicit and mixed steps).
  StepReport Step(TetState& state, const Controls& now, const Controls& next, double dt);

  // One attempt to make a step. Sets all of `made` except for what ProposeStep and Step manage.
  StepReport Attempt(const TetState& now, const Controls& controls_now, const Controls& controls_next, double dt,
                     TetState& made);

  // The largest stable step at a state [s], see LargestStableStep.
  double StableStepAt(const TetState& state, const Controls& now);

  static constexpr int kMaxCuts = 10;

 private:
  // The controls at both ends of a step, and its length.
  struct StepControls {
    const Controls& now;
    const Controls& next;
    double dt;  // [s]
  };
  // Central difference method in kick-drift-kick form; viscous forces use the velocity of the half step.
  StepReport StepExplicit(const TetState& now, const StepControls& step, TetState& next);
  // Explicit elastic forces, implicit damping [Teran 2003, 4.3].
  StepReport StepMixed(const TetState& now, const StepControls& step, TetState& next);

  // Steppings that solve for the end of the step: implicit_step.cc.
  StepReport StepImplicit(const TetState& now, const StepControls& step, TetState& next);
  // What a step solves for: the positions of prescribed components, the controls at its end, and how.
  struct PositionSolve {
    const NodalVector& target;
    const Controls& controls;
    NewtonOptions options;
  };
  NewtonResult SolvePositions(const PositionSolve& solve, TetState& next);
  NewtonResult SolveCorrected(PositionSolve solve, const TetState& now, const StepControls& step, double weight,
                              TetState& next);
  double ErrorOf(const LoadExpansion& expansion, const NodalVector& load, const Controls& controls,
                 const NodalVector& x) const;
  StepProposal ProposeExplicit(TetState& state, const Controls& now, double end);
  StepProposal ProposeImplicit(const TetState& state, double end) const;
  bool ControlsError() const { return method_.step_error && method_.stepping != Stepping::kQuasiStatic; }
  ErrorTerm ErrorTermAt(const TetState& now) const;
  void AcceptImplicit(TetState& state, const StepReport& report, double dt);
  bool CutImplicit(TetState& state, const StepReport& report, double dt) const;
  bool IsImplicit() const { return method_.stepping != Stepping::kExplicit && method_.stepping != Stepping::kMixed; }
  void CompleteState(const Controls& start, TetState& state);
  void SettleMiddles(const Controls& start, TetState& state);
  void SetFirstAcceleration(const Controls& start, TetState& state);
  StepReport SolveStatic(const Controls& controls, TetState& state);
  double SmallestRatio(const NodalVector& x) const;
  FibreDrive DriveOf(const TetState& now, const StepControls& step) const;

  void UpdateExternalForces(const TetState& now, const StepControls& step);
  void CompleteExternalForces(const StepControls& step, const NodalVector& positions);
  void Drift(const TetState& now, const StepControls& step, TetState& next);
  CgResult SolveDamping(const NodalVector& x, const NodalVector& internal, const NodalVector& external,
                        double half_step, TetState& next);
  ForceReport UpdateForce(const NodalVector* viscous_velocity, const FibreDrive& drive, const Controls& controls,
                          TetState& next);
  // Computes the quantities that detect an unstable step; next.velocities are those of the half step.
  void MeasureMotion(const TetState& now, const TetState& next, StepReport& report) const;

  // Work during a step: work.cc. Adds that of loads, supports and activation.
  void AddWork(const TetState& now, const StepControls& step, TetState& next);
  void AddStaticWork(const TetState& now, const StepControls& step, double of_loads, TetState& next);
  double DynamicWorkOfSupports(const TetState& now, const StepControls& step, const TetState& next);
  bool HasBranches() const { return model_.branch_points() > 0; }
  // The activations and, if there are any, the branches at a state.
  FibreDrive StateDrive(const TetState& state, std::span<const double> activations);
  NodalVector ElasticAndFloorForce(const FibreDrive& drive, const NodalVector& x);
  bool HasContact() const { return !model_.contact().empty(); }
  // What touches rigid bodies at a state, under the controls of its time.
  const std::vector<Touch>& TouchesAt(const TetState& state, const Controls& controls);
  // The same with contact.
  NodalVector InternalForce(const FibreDrive& drive, const TetState& state, const Controls& controls);
  double WorkOfRigidBodies(const TetState& now, const StepControls& step, const TetState& next);
  // Whether contacts are deeper than they may be; their firmness in `made` is then larger.
  bool MakeFirmer(const Controls& controls, TetState& made);
  double ElasticEnergyAt(const FibreDrive& drive, const NodalVector& x);

  bool IsStableStepDue(const TetState& state, const Controls& now) const;
  void RefreshStableStep(TetState& state, const Controls& now);
  double TargetStep(const TetState& state) const;
  StepProblem Judge(const TetState& now, const TetState& next, const StepReport& report) const;
  void AcceptExplicit(TetState& state, const StepReport& report);
  bool CutStep(TetState& state, const Controls& now, const StepReport& report, double dt);
  void FindWhere(const TetState& state, const Controls& next, StepReport& report) const;

  const TetModel& model_;
  ThreadTeam& team_;
  Profile* const profile_;
  const TetMethod& method_;
  // Scratch memory: nothing here outlives a step.
  NodalVector external_now_, external_next_;
  NodalVector held_load_, correction_, corrected_;  // all that an implicit step holds fixed; of EnergyCorrection
  NodalVector right_side_, inverse_diagonal_;
  NodalVector force_before_, force_after_, mean_rate_, viscous_;  // for the work of supports
  ForceWorkspace forces_;
  BranchDrive step_branches_, state_branches_;
  CgWorkspace cg_;
  StableStepWorkspace stable_step_;
  std::unique_ptr<NewtonSolver> newton_;                 // for implicit steppings
  std::unique_ptr<EnergyCorrection> energy_correction_;  // for kNewmark
  IncrementalPotential potential_;
  ContactSearch contact_;
  ContactDrive contact_drive_;  // of potential_
  TetState next_;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_SOLVER_H_
