// The equilibrium in which a scene may begin: TetSolver::SolveEquilibrium.
#include <Eigen/Geometry>

#include <utility>

#include "core/tet/solver.h"

namespace fascicle {
namespace {

// The shortest part of loads and motions that is tried.
constexpr double kLeastPart = 0x1p-12;

// A part of a rigid motion: the same axis and direction.
RigidMotion MotionPart(const RigidMotion& whole, double part) {
  const Eigen::AngleAxisd rotation(whole.rotation);
  RigidMotion motion = whole;
  if (part < 1) motion.rotation = Eigen::AngleAxisd(part * rotation.angle(), rotation.axis()).toRotationMatrix();
  motion.translation *= part;
  return motion;
}

// The controls with everything that acts reduced to a part of it.
Controls ControlsPart(const Controls& whole, double part) {
  Controls controls = whole;
  for (double& activation : controls.activations) activation *= part;
  for (double& scale : controls.load_scales) scale *= part;
  for (RigidMotion& motion : controls.motions) motion = MotionPart(motion, part);
  for (RigidMotion& motion : controls.rigid_motions) motion = MotionPart(motion, part);
  controls.gravity_scale *= part;
  return controls;
}

StepProblem ProblemOfStart(const NewtonResult& result) {
  if (result.end == NewtonResult::End::kConverged) return StepProblem::kNone;
  return result.end == NewtonResult::End::kInvalid ? StepProblem::kInvertedElement : StepProblem::kNoEquilibrium;
}

}  // namespace

StepReport TetSolver::SolveEquilibrium(const Controls& start, TetState& state) {
  const StageTimer timer(profile_, "start");
  const bool borrows_newton = newton_ == nullptr;
  if (borrows_newton) newton_ = std::make_unique<NewtonSolver>(model_, team_, profile_);
  state.positions = model_.InitialPositions();
  state.pressures.assign(model_.patches().size(), 0.0);
  const NodalVector before = state.positions;
  StepReport report;
  double done = 0, part = 1;
  while (done < 1) {
    const double next = done + part < 1 ? done + part : 1;
    StepReport attempt = SolveStatic(next < 1 ? ControlsPart(start, next) : start, state);
    report.iterations += attempt.iterations;
    report.problem = attempt.problem;
    if (attempt.problem == StepProblem::kNone) {
      done = next;
    } else if (part /= 2; part < kLeastPart) {
      report.bad = std::move(attempt.bad);
      break;
    }
  }
  if (report.problem == StepProblem::kNone) report.strain = LargestStepStrain(model_, before, state.positions);
  state.iterations += report.iterations;
  state.velocities.assign(model_.nodes(), Vec3::Zero());
  if (IsImplicit()) {
    state.previous_positions = state.positions;
    state.previous_velocities = state.velocities;
  } else {
    state.pressures.clear();
  }
  CompleteState(start, state);
  if (borrows_newton) newton_.reset();
  return report;
}

// Moves positions and pressures to the equilibrium of the controls; leaves the state on a problem.
StepReport TetSolver::SolveStatic(const Controls& controls, TetState& state) {
  potential_ = {};
  potential_.drive = FibreDrive{controls.activations};
  potential_.previous = &state.positions;
  ExternalForce(model_, controls, team_, held_load_);
  NodalVector target = state.positions;
  PrescribePositions(model_, controls, target);
  next_.positions = state.positions;
  next_.pressures = state.pressures;
  next_.contact_firmness = state.contact_firmness;
  if (HasContact()) {
    contact_drive_ = {PlacementsOf(model_, controls), state.contact_firmness, &state.positions, nullptr, {}};
    potential_.contact = &contact_drive_;
  }
  NewtonResult result = SolvePositions({target, controls, {}}, next_);
  while (result.end == NewtonResult::End::kConverged && MakeFirmer(controls, next_)) {
    contact_drive_.firmness = next_.contact_firmness;
    result = SolvePositions({target, controls, {}}, next_);
  }
  StepReport report;
  report.iterations = result.iterations;
  report.problem = ProblemOfStart(result);
  if (report.problem == StepProblem::kNoEquilibrium) report.bad = FindElementsAt(model_, result.node);
  if (report.problem == StepProblem::kInvertedElement) {
    report.bad = FindBadElements(model_, potential_.drive, next_.positions);
  }
  if (report.problem == StepProblem::kNone) {
    std::swap(state.positions, next_.positions);
    std::swap(state.pressures, next_.pressures);
    state.contact_firmness = next_.contact_firmness;
  }
  potential_ = {};
  return report;
}

}  // namespace fascicle
