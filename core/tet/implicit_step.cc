// Implicit steps, which solve for the positions at their end: backward Euler, generalized alpha, BDF2 and quasi-static.
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/tet/diagnostics.h"
#include "core/tet/floor_contact.h"
#include "core/tet/solver.h"

namespace fascicle {
namespace {

// After a step with at most this many iterations the next one may be twice as long.
constexpr int kEasyIterations = 10;
// Static solutions are extrapolated to at most this multiple of the last step.
constexpr double kFarthest = 4;
// A run fails when it needs steps shorter than this part of its longest step.
constexpr double kShortestStep = 0x1p-12;
// The same of runs whose error is controlled: where a load jumps, any step may be needed.
constexpr double kShortestAccurateStep = 0x1p-24;
// A step whose loads still depend on its positions after this many expansions is too long.
constexpr int kMostExpansions = 30;

// The correction of forces is repeated until it agrees with the positions, at most so often, to a tolerance that falls
// by this factor from the first.
constexpr int kMostCorrections = 12;
constexpr double kFirstTolerance = 1e-4, kToleranceFactor = 1e-2;
// Where contacts are deeper than this part of what is allowed, all become firmer by a factor, up to the last one.
constexpr double kDeep = 0.9, kFirmer = 4, kFirmest = 256;
// A correction agrees with the positions if it changes by less than this part of the forces.
constexpr double kAgreement = 1e-6;

// Velocity and acceleration at the end of a step as functions of the positions there, v = rate (x - v_centre),
// a = inertia (x - a_centre), and the balance that determines x: all forces at the end, plus those kept from its start,
// equal share M a. Generalized alpha divides its balance by the weight of the end.
struct Scheme {
  double rate = 0;     // [1/s]
  double inertia = 0;  // [1/s^2]
  double share = 1;
  NodalVector v_centre, a_centre;
  NodalVector kept;  // [N]; empty: none
};

// Generalized alpha [Chung & Hulbert 1993, A time integration algorithm for structural dynamics with improved numerical
// dissipation, J. Appl. Mech. 60]:
//   (1 - inertia_weight) M a' + inertia_weight M a = (1 - force_weight) f' + force_weight f.
struct Alpha {
  double inertia_weight, force_weight, beta, gamma;

  explicit Alpha(double spectral_radius)
      : inertia_weight((2 * spectral_radius - 1) / (spectral_radius + 1)),
        force_weight(spectral_radius / (spectral_radius + 1)),
        beta(0.25 * std::pow(1 - inertia_weight + force_weight, 2)),
        gamma(0.5 - inertia_weight + force_weight) {}
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

Scheme BackwardSchemeOf(Stepping stepping, const TetState& now, double dt) {
  const bool has_history = stepping == Stepping::kBdf2 && now.step > 0;
  return BackwardScheme(has_history ? SecondOrder(dt / now.time_step) : BackwardDifference(), now, dt);
}

Scheme AlphaScheme(const Alpha& alpha, const TetModel& model, const TetState& now, double dt) {
  Scheme scheme;
  scheme.rate = alpha.gamma / (alpha.beta * dt);
  scheme.inertia = 1 / (alpha.beta * dt * dt);
  scheme.share = (1 - alpha.inertia_weight) / (1 - alpha.force_weight);
  for (std::size_t n = 0; n < now.positions.size(); ++n) {
    const Vec3 &x = now.positions[n], &v = now.velocities[n], &a = now.accelerations[n];
    scheme.a_centre.push_back(x + dt * v + dt * dt * (0.5 - alpha.beta) * a);
    scheme.v_centre.push_back(scheme.a_centre.back() - (v + dt * (1 - alpha.gamma) * a) / scheme.rate);
    scheme.kept.push_back((alpha.force_weight * now.force[n] - alpha.inertia_weight * model.mass()[n] * a) /
                          (1 - alpha.force_weight));
  }
  return scheme;
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
  if (report.error >= 0) {
    const double allowed = NextLength(ErrorTermAt(state), report.error, *method_.step_error) * dt;
    next_.next_step = std::min(next_.next_step, allowed);
  }
  std::swap(state, next_);
}

bool TetSolver::CutImplicit(TetState& state, const StepReport& report, double dt) const {
  state.next_step = dt / 2;
  if (report.problem == StepProblem::kInaccurate) {
    state.next_step = std::min(NextLength(ErrorTermAt(state), report.error, *method_.step_error), 0.9) * dt;
  }
  const Scene& scene = model_.scene();
  // Steps end at frames.
  double longest = std::min(scene.duration, scene.output.frame_interval);
  if (method_.time_step) longest = std::min(longest, *method_.time_step);
  return !(state.next_step < (ControlsError() ? kShortestAccurateStep : kShortestStep) * longest);
}

// The leading error of the step that begins at a state.
ErrorTerm TetSolver::ErrorTermAt(const TetState& now) const {
  if (method_.stepping == Stepping::kNewmark) return {std::abs(1.0 / 6 - Alpha(method_.spectral_radius).beta), true, 3};
  if (method_.stepping == Stepping::kBdf2 && now.step > 0) return {2.0 / 9, true, 3};
  return {0.5, false, 2};
}

StepReport TetSolver::StepImplicit(const TetState& now, const StepControls& step, TetState& next) {
  const double dt = step.dt;
  const bool is_static = method_.stepping == Stepping::kQuasiStatic;
  const bool is_alpha = method_.stepping == Stepping::kNewmark;
  const Alpha alpha(method_.spectral_radius);
  next.positions = now.positions;
  next.pressures = now.pressures;
  NodalVector target = now.positions;
  PrescribePositions(model_, step.next, target);

  potential_.drive = DriveOf(now, step);
  // Fibres of a state of rest are isometric.
  if (is_static) potential_.drive.inverse_step = 0;
  potential_.previous = &now.positions;
  potential_.viscous_rate = is_static || !model_.has_strain_damping() ? 0 : 1 / dt;
  potential_.floor_start = is_alpha ? &now.positions : nullptr;
  held_load_ = external_next_;
  Scheme scheme;
  NodalVector continued = now.positions;  // extrapolated, as if free components kept their acceleration
  if (!is_static) {
    scheme = is_alpha ? AlphaScheme(alpha, model_, now, dt) : BackwardSchemeOf(method_.stepping, now, dt);
    // Mass damping a M v is combined with inertia: m (x - c) = M [inertia (x - a_centre) + a rate (x - v_centre)].
    potential_.inertia.resize(model_.nodes());
    potential_.inertia_centre.resize(model_.nodes());
    const double inertia = scheme.share * scheme.inertia;
    for (std::size_t n = 0; n < model_.nodes(); ++n) {
      const double damping = model_.mass_damping()[n] * scheme.rate;
      const double sum = inertia + damping;
      potential_.inertia[n] = model_.mass()[n] * sum;
      potential_.inertia_centre[n] = (inertia * scheme.a_centre[n] + damping * scheme.v_centre[n]) / sum;
      const Vec3 free = model_.mass()[n] * model_.inverse_mass()[n];
      const Vec3 ahead = scheme.a_centre[n] + now.accelerations[n] / scheme.inertia;
      continued[n] += free.cwiseProduct(ahead - now.positions[n]);
      if (is_alpha) held_load_[n] += scheme.kept[n];
    }
  }
  PositionSolve solve = {target, step.next, {}};
  solve.options.tolerance = method_.newton_tolerance;
  if (!is_static) solve.options.guess = &continued;
  if (is_static && now.step > 0 && dt <= kFarthest * now.time_step) {
    solve.options.before = &now.previous_positions;
    solve.options.ahead = dt / now.time_step;
  }
  if (HasContact()) {
    contact_drive_ = {
        PlacementsOf(model_, step.next), next.contact_firmness, &now.positions, potential_.floor_start, {}};
    if (is_alpha) contact_drive_.at_start = PlacementsOf(model_, step.now);
    potential_.contact = &contact_drive_;
  }
  const auto solve_once = [&] {
    return is_alpha ? SolveCorrected(solve, now, step, 1 - alpha.force_weight, next) : SolvePositions(solve, next);
  };
  NewtonResult result = solve_once();
  while (result.end == NewtonResult::End::kConverged && MakeFirmer(step.next, next)) {
    contact_drive_.firmness = next.contact_firmness;
    solve.options.guess = solve.options.before = nullptr;
    if (is_alpha) held_load_ = external_next_;
    for (std::size_t n = 0; is_alpha && n < model_.nodes(); ++n) held_load_[n] += scheme.kept[n];
    const NewtonResult again = solve_once();
    AddTo(result, again);
  }
  potential_.contact = nullptr;

  StepReport report;
  report.iterations = result.iterations;
  report.solves = result.solves;
  report.residual = result.residual;
  report.problem = ProblemOf(result);
  if (report.problem == StepProblem::kNoEquilibrium) report.bad = FindElementsAt(model_, result.node);
  next.iterations = now.iterations + result.iterations;
  if (report.problem != StepProblem::kNone) return report;
  CompleteExternalForces(step, next.positions);

  next.velocities.assign(model_.nodes(), Vec3::Zero());
  next.accelerations.assign(model_.nodes(), Vec3::Zero());
  next.previous_positions = now.positions;
  next.previous_velocities = now.velocities;
  next.force = now.force;
  if (!is_static) {
    for (std::size_t n = 0; n < model_.nodes(); ++n) {
      next.velocities[n] = scheme.rate * (next.positions[n] - scheme.v_centre[n]);
      const Vec3 free = model_.mass()[n] * model_.inverse_mass()[n];
      next.accelerations[n] = free.cwiseProduct(scheme.inertia * (next.positions[n] - scheme.a_centre[n]));
      if (!is_alpha) continue;
      const Vec3 kept = scheme.kept[n] + correction_[n] / (1 - alpha.force_weight);
      next.force[n] = free.cwiseProduct(scheme.share * model_.mass()[n] * next.accelerations[n] - kept);
    }
    PrescribeVelocities(model_, step.next, next.velocities);
  }
  if (is_alpha && (!model_.scene().floors.empty() || HasContact())) {
    // The next step begins with the contacts' own force, in place of that which made the mean exact.
    NodalVector own(model_.nodes(), Vec3::Zero()), mean(model_.nodes(), Vec3::Zero());
    AddFloorForce(model_, next.positions, own);
    AddFloorForce(model_, next.positions, mean, &now.positions);
    if (HasContact()) {
      AddContactForce(contact_.Find(contact_drive_, next.positions, team_), mean);
      AddContactForce(TouchesAt(next, step.next), own);
    }
    for (std::size_t n = 0; n < model_.nodes(); ++n) {
      const Vec3 free = model_.mass()[n] * model_.inverse_mass()[n];
      next.force[n] += free.cwiseProduct(own[n] - mean[n]);
    }
  }
  if (ControlsError()) {
    report.error = ErrorOfStep(model_, ErrorTermAt(now), now, next);
    if (report.error > *method_.step_error) report.problem = StepProblem::kInaccurate;
  }
  if (is_static) report.strain = LargestStepStrain(model_, now.positions, next.positions);
  next.stable = now.stable;
  next.smallest_ratio = SmallestRatio(next.positions);
  next.peak_kinetic = now.peak_kinetic;
  return report;
}

bool TetSolver::MakeFirmer(const Controls& controls, TetState& made) {
  if (!HasContact() || made.contact_firmness >= kFirmest) return false;
  if (!(LargestExcess(TouchesAt(made, controls)) > kDeep)) return false;
  made.contact_firmness *= kFirmer;
  return true;
}

// Solves for the positions at the end of a step whose forces are corrected so that they do the work that the energy
// loses (EnergyCorrection). The correction belongs to the last positions: it is small and smooth, so that few
// repetitions with falling tolerances suffice. `weight` is that of the forces at the end.
NewtonResult TetSolver::SolveCorrected(PositionSolve solve, const TetState& now, const StepControls& step,
                                       double weight, TetState& next) {
  const double tolerance = solve.options.tolerance;
  const NodalVector held = held_load_;
  {
    const StageTimer timer(profile_, "energy correction");
    energy_correction_->Start(now.positions, step.now.activations, step.next.activations, team_);
  }
  correction_.assign(model_.nodes(), Vec3::Zero());
  solve.options.tolerance = std::max(tolerance, kFirstTolerance);
  NewtonResult total;
  for (int k = 0; k < kMostCorrections; ++k) {
    const NewtonResult result = SolvePositions(solve, next);
    AddTo(total, result);
    if (result.end != NewtonResult::End::kConverged) return total;
    const StageTimer timer(profile_, "energy correction");
    energy_correction_->At(next.positions, team_, corrected_);
    const double change = std::sqrt(SumOverNodes(
        team_, model_.nodes(), [&](std::size_t n) { return (corrected_[n] - correction_[n]).squaredNorm(); }));
    const bool agrees = change <= std::max(tolerance, kAgreement) * result.force_scale;
    if (agrees && solve.options.tolerance == tolerance) return total;
    // What comes next is the last solution, or one with a better correction.
    solve.options.tolerance = agrees ? tolerance : std::max(tolerance, kToleranceFactor * solve.options.tolerance);
    solve.options.guess = nullptr;
    std::swap(correction_, corrected_);
    ForNodes(team_, model_.nodes(), [&](std::size_t n) { held_load_[n] = held[n] + correction_[n] / weight; });
  }
  total.end = NewtonResult::End::kNotConverged;
  return total;
}

// Solves for the positions and pressures at the end of the step. Loads that depend on positions are expanded about the
// last solution until the expansion is as exact as the equilibrium: a pressure has no potential at a free rim, so that
// Newton's line search has nothing to decrease but that of its expansion.
NewtonResult TetSolver::SolvePositions(const PositionSolve& solve, TetState& next) {
  const StageTimer timer(profile_, "Newton");
  NewtonOptions options = solve.options;
  potential_.load = &held_load_;
  if (model_.position_loads().empty()) {
    return newton_->Solve(potential_, solve.target, options, next.positions, next.pressures);
  }
  NewtonResult total;
  for (int expansions = 0; expansions < kMostExpansions; ++expansions) {
    const LoadExpansion expansion = ExpandPositionLoads(model_, solve.controls.load_scales, next.positions);
    NodalVector load = held_load_;
    AddPositionLoads(model_, solve.controls.load_scales, next.positions, load);
    potential_.load = &load;
    potential_.expansion = &expansion;
    const NewtonResult result = newton_->Solve(potential_, solve.target, options, next.positions, next.pressures);
    potential_.load = &held_load_;
    potential_.expansion = nullptr;
    options.guess = options.before = nullptr;
    AddTo(total, result);
    if (result.end != NewtonResult::End::kConverged) return total;
    const double error = ErrorOf(expansion, load, solve.controls, next.positions);
    if (error <= options.tolerance * result.force_scale) return total;
  }
  total.end = NewtonResult::End::kNotConverged;
  return total;
}

// Norm of what the expansion misses in the force on free components [N]. `load` is the force at its centre.
double TetSolver::ErrorOf(const LoadExpansion& expansion, const NodalVector& load, const Controls& controls,
                          const NodalVector& x) const {
  NodalVector exact = held_load_, change;
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
