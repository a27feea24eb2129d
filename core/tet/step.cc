// One step of each stepping: TetSolver::Step and its parts.
#include "core/tet/floor_contact.h"
#include "core/tet/solver.h"

namespace fascicle {
namespace {

constexpr int kMaxCgIterations = 2000;

StepProblem ProblemOf(const ForceReport& report, const CgResult& solve = {true, 0}) {
  if (!report.valid) return StepProblem::kInvertedElement;
  return solve.converged ? StepProblem::kNone : StepProblem::kNotConverged;
}

}  // namespace

StepReport TetSolver::Attempt(const TetState& now, const Controls& controls_now, const Controls& controls_next,
                              double dt, TetState& made) {
  const StepControls step = {controls_now, controls_next, dt};
  made.time = controls_next.time;
  made.step = now.step + 1;
  made.time_step = dt;
  made.dissipated = now.dissipated;
  made.iterations = now.iterations;
  made.contact_firmness = now.contact_firmness;
  UpdateExternalForces(now, step);
  if (HasBranches()) SetStepDrive(model_, now.branches, dt, team_, step_branches_);
  const StepReport report = IsImplicit()                              ? StepImplicit(now, step, made)
                            : method_.stepping == Stepping::kExplicit ? StepExplicit(now, step, made)
                                                                      : StepMixed(now, step, made);
  if (report.problem != StepProblem::kNone) return report;
  if (HasBranches()) {
    const StageTimer timer(profile_, "branches");
    made.dissipated += AdvanceBranches(model_, now.branches, made.positions, dt, team_, forces_, made.branches);
  }
  AddWork(now, step, made);
  return report;
}

// Loads and gravity at both ends of the step. Those that depend on the positions at its end follow when these are
// known.
void TetSolver::UpdateExternalForces(const TetState& now, const StepControls& step) {
  const StageTimer timer(profile_, "external force");
  ExternalForce(model_, step.now, team_, external_now_);
  AddPositionLoads(model_, step.now.load_scales, now.positions, external_now_);
  ExternalForce(model_, step.next, team_, external_next_);
}
void TetSolver::CompleteExternalForces(const StepControls& step, const NodalVector& positions) {
  AddPositionLoads(model_, step.next.load_scales, positions, external_next_);
}

StepReport TetSolver::StepExplicit(const TetState& now, const StepControls& step, TetState& next) {
  StepReport report;
  const double dt = step.dt, h = dt / 2;
  const NodalVector& inverse_mass = model_.inverse_mass();
  const std::vector<double>& a = model_.mass_damping();

  // v_half = v + dt/2 (M^-1 f - a v)
  next.velocities.resize(model_.nodes());
  {
    const StageTimer timer(profile_, "velocities");
    ForNodes(team_, model_.nodes(), [&](std::size_t n) {
      next.velocities[n] =
          (1 - h * a[n]) * now.velocities[n] + h * inverse_mass[n].cwiseProduct(now.force[n] + external_now_[n]);
    });
  }
  // x' = x + dt v_half
  Drift(now, step, next);
  CompleteExternalForces(step, next.positions);
  // f' = f(x', v_half)
  const ForceReport forces =
      UpdateForce(model_.has_strain_damping() ? &next.velocities : nullptr, DriveOf(now, step), step.next, next);
  MeasureMotion(now, next, report);
  next.dissipated += dt * forces.dissipated_power;
  if (model_.has_mass_damping()) {
    next.dissipated += dt * SumOverNodes(team_, model_.nodes(), [&](std::size_t n) {
                         return a[n] * model_.mass()[n] * next.velocities[n].squaredNorm();
                       });
  }
  // v' = v_half + dt/2 (M^-1 f' - a v')
  {
    const StageTimer timer(profile_, "velocities");
    ForNodes(team_, model_.nodes(), [&](std::size_t n) {
      next.velocities[n] =
          (next.velocities[n] + h * inverse_mass[n].cwiseProduct(next.force[n] + external_next_[n])) / (1 + h * a[n]);
    });
    PrescribeVelocities(model_, step.next, next.velocities);
  }
  report.problem = ProblemOf(forces);
  return report;
}

StepReport TetSolver::StepMixed(const TetState& now, const StepControls& step, TetState& next) {
  StepReport report;
  const double dt = step.dt;
  // (M - dt/2 D) v_half = M v + dt/2 f(x)
  next.velocities = now.velocities;
  const CgResult first = SolveDamping(now.positions, now.force, external_now_, dt / 2, next);
  // x' = x + dt v_half
  Drift(now, step, next);
  CompleteExternalForces(step, next.positions);
  // f' = f(x')
  const ForceReport forces = UpdateForce(nullptr, DriveOf(now, step), step.next, next);
  MeasureMotion(now, next, report);
  report.problem = ProblemOf(forces, first);
  report.iterations = first.iterations;
  if (report.problem != StepProblem::kNone) return report;
  // (M - dt/2 D) v' = M v_half + dt/2 f'
  const CgResult second = SolveDamping(next.positions, next.force, external_next_, dt / 2, next);
  report.problem = ProblemOf(forces, second);
  report.iterations += second.iterations;
  next.iterations += report.iterations;
  return report;
}

// x' = x + dt v_half; prescribed components get their target position and, in v_half, the velocity that leads there.
void TetSolver::Drift(const TetState& now, const StepControls& step, TetState& next) {
  const StageTimer timer(profile_, "positions");
  const double dt = step.dt;
  next.positions.resize(model_.nodes());
  ForNodes(team_, model_.nodes(),
           [&](std::size_t n) { next.positions[n] = now.positions[n] + dt * next.velocities[n]; });
  PrescribePositions(model_, step.next, next.positions);
  for (const Support& support : model_.supports()) {
    for (std::size_t i = 0; i < support.nodes.size(); ++i) {
      const std::int32_t n = support.nodes[i];
      for (int c = 0; c < 3; ++c) {
        if (support.owned[i][c]) next.velocities[n][c] = (next.positions[n][c] - now.positions[n][c]) / dt;
      }
    }
  }
}

// The fibre drive at the end of a step.
FibreDrive TetSolver::DriveOf(const TetState& now, const StepControls& step) const {
  FibreDrive drive{step.next.activations, &now.positions, 1 / step.dt};
  if (HasBranches()) drive.branches = &step_branches_;
  return drive;
}

ForceReport TetSolver::UpdateForce(const NodalVector* viscous_velocity, const FibreDrive& drive,
                                   const Controls& controls, TetState& next) {
  const StageTimer timer(profile_, "elastic force");
  const ForceReport report =
      viscous_velocity == nullptr
          ? ElasticForce(model_, drive, next.positions, team_, forces_, next.force)
          : ElasticAndViscousForce(model_, drive, next.positions, *viscous_velocity, team_, forces_, next.force);
  AddFloorForce(model_, next.positions, next.force);
  if (HasContact()) {
    const StageTimer contact_timer(profile_, "contact");
    AddContactForce(TouchesAt(next, controls), next.force);
    next.contact_excess = LargestExcess(contact_.touches());
  }
  next.smallest_ratio = report.smallest_ratio;
  return report;
}

const std::vector<Touch>& TetSolver::TouchesAt(const TetState& state, const Controls& controls) {
  return contact_.Find({PlacementsOf(model_, controls), state.contact_firmness, nullptr, nullptr, {}}, state.positions,
                       team_);
}

// Solves (M + dt/2 a M - dt/2 D) v = M v0 + dt/2 f for v, with v0 = next.velocities, in which prescribed components
// keep their value. D is the viscous operator at positions x; half_step is dt/2.
CgResult TetSolver::SolveDamping(const NodalVector& x, const NodalVector& internal, const NodalVector& external,
                                 double half_step, TetState& next) {
  const StageTimer timer(profile_, "damping");
  const std::vector<double>& mass = model_.mass();
  const std::vector<double>& a = model_.mass_damping();
  const NodalVector& inverse_mass = model_.inverse_mass();
  NodalVector& v = next.velocities;
  right_side_.resize(model_.nodes());
  ForNodes(team_, model_.nodes(),
           [&](std::size_t n) { right_side_[n] = mass[n] * v[n] + half_step * (internal[n] + external[n]); });
  if (!model_.has_strain_damping()) {
    next.dissipated += SumOverNodes(team_, model_.nodes(), [&](std::size_t n) {
      // Zero inverse mass marks prescribed components.
      const Vec3 free = mass[n] * inverse_mass[n];
      const Vec3 solved = right_side_[n] / (mass[n] * (1 + half_step * a[n]));
      v[n] = free.cwiseProduct(solved) + (Vec3::Ones() - free).cwiseProduct(v[n]);
      return half_step * a[n] * mass[n] * v[n].squaredNorm();
    });
    return {true, 0};
  }
  inverse_diagonal_.resize(model_.nodes());
  ViscousDiagonal(model_, x, team_, forces_, inverse_diagonal_);
  ForNodes(team_, model_.nodes(), [&](std::size_t n) {
    const Vec3 diagonal = Vec3::Constant(mass[n] * (1 + half_step * a[n])) + half_step * inverse_diagonal_[n];
    inverse_diagonal_[n] = (mass[n] * inverse_mass[n]).cwiseQuotient(diagonal);
  });
  const auto apply = [&](const NodalVector& p, NodalVector& q) {
    ViscousForce(model_, x, p, team_, forces_, q);
    ForNodes(team_, model_.nodes(),
             [&](std::size_t n) { q[n] = mass[n] * (1 + half_step * a[n]) * p[n] - half_step * q[n]; });
  };
  const CgResult result = ConjugateGradient(team_, apply, inverse_diagonal_, right_side_, method_.solver_tolerance,
                                            kMaxCgIterations, v, cg_);
  // Since A v = b - r, the energy lost in this half step, v . (A - M) v, needs no further product.
  next.dissipated += SumOverNodes(team_, model_.nodes(), [&](std::size_t n) {
    return v[n].dot(right_side_[n] - cg_.residual[n] - mass[n] * v[n]);
  });
  return result;
}

void TetSolver::MeasureMotion(const TetState& now, const TetState& next, StepReport& report) const {
  const StageTimer timer(profile_, "stability");
  const double twice_kinetic = SumOverNodes(team_, model_.nodes(), [&](std::size_t n) {
    const double m = model_.mass()[n];
    return m * m * model_.inverse_mass()[n].dot(next.velocities[n].cwiseAbs2());
  });
  report.kinetic = twice_kinetic / 2;
  if (!(twice_kinetic > 0)) return;
  const double work = SumOverNodes(team_, model_.nodes(), [&](std::size_t n) {
    const Vec3 free = model_.mass()[n] * model_.inverse_mass()[n];
    return free.dot((next.force[n] - now.force[n]).cwiseProduct(next.positions[n] - now.positions[n]));
  });
  report.stiffness_of_motion = -work / twice_kinetic;
}

}  // namespace fascicle
