// Implicit steps, which solve for the positions at their end: backward Euler, Newmark, BDF2 and quasi-static.
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/tet/diagnostics.h"
#include "core/tet/solver.h"

namespace fascicle {
namespace {

// After a step with at most this many iterations the next one may be twice as long.
constexpr int kEasyIterations = 10;
// Static solutions are extrapolated to at most this multiple of the last step.
constexpr double kFarthest = 4;
// A run fails when it needs steps shorter than this part of its duration.
constexpr double kShortestStep = 0x1p-12;
// A step whose loads still depend on its positions after this many expansions is too long.
constexpr int kMostExpansions = 30;

// Velocity and inertia force at the end of a step as functions of the positions there: v = rate (x - v_centre), M a =
// inertia M (x - a_centre).
struct Scheme {
  double rate = 0;     // [1/s]
  double inertia = 0;  // [1/s^2]
  NodalVector v_centre, a_centre;
};

// The rate at the end of a step is (c0 x + c1 x_n + c2 x_{n-1}) / dt. The previous step had length dt / ratio.
struct BackwardDifference {
  double c0 = 1, c1 = -1, c2 = 0;
};
BackwardDifference SecondOrder(double ratio) {
  return {(1 + 2 * ratio) / (1 + ratio), -(1 + ratio), ratio * ratio / (1 + ratio)};
}

Scheme BackwardScheme(const BackwardDifference& d, const TetState& now, double dt) {
  Scheme scheme;
  scheme.rate = d.c0 / dt;
  scheme.inertia = scheme.rate * scheme.rate;
  for (std::size_t n = 0; n < now.positions.size(); ++n) {
    Vec3 x = d.c1 * now.positions[n], v = d.c1 * now.velocities[n];
    if (d.c2 != 0) {
      x += d.c2 * now.previous_positions[n];
      v += d.c2 * now.previous_velocities[n];
    }
    scheme.v_centre.push_back(-x / d.c0);
    // a = (c0 v + v_history) / dt with v = (c0 x + x_history) / dt
    scheme.a_centre.push_back(-(x + dt / d.c0 * v) / d.c0);
  }
  return scheme;
}

// Average acceleration: beta = 1/4, gamma = 1/2 [Newmark 1959].
Scheme NewmarkScheme(const TetState& now, double dt) {
  Scheme scheme;
  scheme.rate = 2 / dt;
  scheme.inertia = 4 / (dt * dt);
  for (std::size_t n = 0; n < now.positions.size(); ++n) {
    scheme.v_centre.push_back(now.positions[n] + dt / 2 * now.velocities[n]);
    scheme.a_centre.push_back(now.positions[n] + dt * now.velocities[n] + dt * dt / 4 * now.accelerations[n]);
  }
  return scheme;
}

Scheme SchemeOf(Stepping stepping, const TetState& now, double dt) {
  if (stepping == Stepping::kNewmark) return NewmarkScheme(now, dt);
  const bool has_history = stepping == Stepping::kBdf2 && now.step > 0;
  return BackwardScheme(has_history ? SecondOrder(dt / now.time_step) : BackwardDifference(), now, dt);
}

StepProblem ProblemOf(const NewtonResult& result) {
  switch (result.end) {
    case NewtonResult::End::kConverged:
      return StepProblem::kNone;
    case NewtonResult::End::kInvalid:
      return StepProblem::kInvertedElement;
    case NewtonResult::End::kNotConverged:
      return StepProblem::kNoEquilibrium;
  }
  return StepProblem::kNoEquilibrium;
}

// Adds the iterations of a further solution, whose outcome is that of all.
void AddTo(NewtonResult& total, const NewtonResult& result) {
  const int iterations = total.iterations + result.iterations;
  LinearSolves solves = total.solves;
  solves.direct += result.solves.direct;
  solves.iterative += result.solves.iterative;
  solves.iterations += result.solves.iterations;
  solves.not_converged += result.solves.not_converged;
  total = result;
  total.iterations = iterations;
  total.solves = solves;
}

}  // namespace

StepProposal TetSolver::ProposeImplicit(const TetState& state, double end) const {
  const double remaining = end - state.time;
  double target = method_.time_step ? *method_.time_step : remaining;
  if (state.next_step > 0) target = std::min(target, state.next_step);
  const double steps = std::ceil(remaining / target * (1 - 1e-9));
  StepProposal proposal;
  proposal.time = steps <= 1 ? end : state.time + remaining / steps;
  proposal.dt = proposal.time - state.time;
  return proposal;
}

void TetSolver::AcceptImplicit(TetState& state, const StepReport& report, double dt) {
  next_.next_step = report.iterations <= kEasyIterations ? 2 * dt : dt;
  std::swap(state, next_);
}

bool TetSolver::CutImplicit(TetState& state, double dt) const {
  state.next_step = dt / 2;
  return !(dt / 2 < kShortestStep * model_.scene().duration);
}

StepReport TetSolver::StepImplicit(const TetState& now, const StepControls& step, TetState& next) {
  const double dt = step.dt;
  const bool is_static = method_.stepping == Stepping::kQuasiStatic;
  next.positions = now.positions;
  next.pressures = now.pressures;
  NodalVector target = now.positions;
  PrescribePositions(model_, step.next, target);

  potential_.drive = DriveOf(now, step);
  // Fibres of a state of rest are isometric.
  if (is_static) potential_.drive.inverse_step = 0;
  potential_.load = &external_next_;
  potential_.previous = &now.positions;
  potential_.viscous_rate = is_static || !model_.has_strain_damping() ? 0 : 1 / dt;
  Scheme scheme;
  NodalVector continued = now.positions;  // extrapolated, as if free components kept their acceleration
  if (!is_static) {
    scheme = SchemeOf(method_.stepping, now, dt);
    // Mass damping a M v is combined with inertia: m (x - c) = M [inertia (x - a_centre) + a rate (x - v_centre)].
    potential_.inertia.resize(model_.nodes());
    potential_.inertia_centre.resize(model_.nodes());
    for (std::size_t n = 0; n < model_.nodes(); ++n) {
      const double damping = model_.mass_damping()[n] * scheme.rate;
      const double sum = scheme.inertia + damping;
      potential_.inertia[n] = model_.mass()[n] * sum;
      potential_.inertia_centre[n] = (scheme.inertia * scheme.a_centre[n] + damping * scheme.v_centre[n]) / sum;
      const Vec3 free = model_.mass()[n] * model_.inverse_mass()[n];
      const Vec3 ahead = scheme.a_centre[n] + now.accelerations[n] / scheme.inertia;
      continued[n] += free.cwiseProduct(ahead - now.positions[n]);
    }
  }
  NewtonOptions options;
  options.tolerance = method_.newton_tolerance;
  if (!is_static) options.guess = &continued;
  if (is_static && now.step > 0 && dt <= kFarthest * now.time_step) {
    options.before = &now.previous_positions;
    options.ahead = dt / now.time_step;
  }
  const NewtonResult result = SolvePositions(target, options, step.next, next);

  StepReport report;
  report.iterations = result.iterations;
  report.solves = result.solves;
  report.problem = ProblemOf(result);
  if (report.problem == StepProblem::kNoEquilibrium) report.bad = FindElementsAt(model_, result.node);
  next.iterations = now.iterations + result.iterations;
  if (report.problem != StepProblem::kNone) return report;
  CompleteExternalForces(step, next.positions);

  next.velocities.assign(model_.nodes(), Vec3::Zero());
  next.accelerations.assign(model_.nodes(), Vec3::Zero());
  next.previous_positions = now.positions;
  next.previous_velocities = now.velocities;
  if (!is_static) {
    for (std::size_t n = 0; n < model_.nodes(); ++n) {
      next.velocities[n] = scheme.rate * (next.positions[n] - scheme.v_centre[n]);
      const Vec3 free = model_.mass()[n] * model_.inverse_mass()[n];
      next.accelerations[n] = free.cwiseProduct(scheme.inertia * (next.positions[n] - scheme.a_centre[n]));
    }
    PrescribeVelocities(model_, step.next, next.velocities);
  }
  if (is_static) report.strain = LargestStepStrain(model_, now.positions, next.positions);
  next.force = now.force;
  next.stable = now.stable;
  next.smallest_ratio = SmallestRatio(next.positions);
  next.peak_kinetic = now.peak_kinetic;
  return report;
}

// Solves for the positions and pressures at the end of the step. Loads that depend on positions are expanded about the
// last solution until the expansion is as exact as the equilibrium: a pressure has no potential at a free rim, so that
// Newton's line search has nothing to decrease but that of its expansion.
NewtonResult TetSolver::SolvePositions(const NodalVector& target, NewtonOptions options, const Controls& controls,
                                       TetState& next) {
  const StageTimer timer(profile_, "Newton");
  if (model_.position_loads().empty()) {
    return newton_->Solve(potential_, target, options, next.positions, next.pressures);
  }
  NewtonResult total;
  for (int expansions = 0; expansions < kMostExpansions; ++expansions) {
    const LoadExpansion expansion = ExpandPositionLoads(model_, controls.load_scales, next.positions);
    NodalVector load = external_next_;
    AddPositionLoads(model_, controls.load_scales, next.positions, load);
    potential_.load = &load;
    potential_.expansion = &expansion;
    const NewtonResult result = newton_->Solve(potential_, target, options, next.positions, next.pressures);
    potential_.load = &external_next_;
    potential_.expansion = nullptr;
    options.guess = options.before = nullptr;
    AddTo(total, result);
    if (result.end != NewtonResult::End::kConverged) return total;
    const double error = ErrorOf(expansion, load, controls, next.positions);
    if (error <= options.tolerance * result.force_scale) return total;
  }
  total.end = NewtonResult::End::kNotConverged;
  return total;
}

// Norm of what the expansion misses in the force on free components [N]. `load` is the force at its centre.
double TetSolver::ErrorOf(const LoadExpansion& expansion, const NodalVector& load, const Controls& controls,
                          const NodalVector& x) const {
  NodalVector exact = external_next_, change;
  AddPositionLoads(model_, controls.load_scales, x, exact);
  expansion.Multiply(x, change);
  return std::sqrt(SumOverNodes(team_, model_.nodes(), [&](std::size_t n) {
    const Vec3 free = model_.mass()[n] * model_.inverse_mass()[n];
    return free.cwiseProduct(exact[n] - load[n] + change[n]).squaredNorm();
  }));
}

double TetSolver::SmallestRatio(const NodalVector& x) const {
  const StageTimer timer(profile_, "volume ratios");
  double smallest = 1;
  for (std::size_t b = 0; b < model_.bodies().size(); ++b) {
    smallest = std::min(smallest, VolumeRatiosOf(model_, b, x).smallest);
  }
  return smallest;
}

}  // namespace fascicle
