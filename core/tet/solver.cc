#include "core/tet/solver.h"

#include <algorithm>
#include <cmath>

namespace fascicle {
namespace {

// Number of steps between two searches for the stable step: decreased while it changes, increased while it does not.
constexpr std::int64_t kFirstInterval = 64;
constexpr std::int64_t kShortestInterval = 32;
constexpr std::int64_t kLongestInterval = 1024;
constexpr double kMuchChange = 0.05;
constexpr double kLittleChange = 0.02;
// A change of an activation by more than this since the last search triggers another search.
constexpr double kActivationChange = 0.1;
// A crushed element stiffens with 1/J^2. A smallest J below this fraction of its value at the last search triggers
// another search; a step in which it falls by more is too long.
constexpr double kRatioChange = 0.9;
constexpr double kRatioChangeOfStep = 0.8;
// A kinetic energy below this fraction of the run's largest says nothing about stability.
constexpr double kFaintMotion = 1e-6;
// Number of successful steps after which a halving is undone.
constexpr std::int64_t kGrowAfter = 50;
// A run fails when it needs more steps than this to the next frame.
constexpr double kMostSteps = 1e9;
// Stiffness that holds corners while mid-edge nodes find their places, relative to that of an element.
constexpr double kHoldOfCorners = 1e4;

// Whether a body has initial displacements, of the nodes of its mesh alone.
bool DisplacesCornersOnly(const Scene& scene) {
  return std::any_of(scene.bodies.begin(), scene.bodies.end(), [](const Body& body) {
    const TetShape& shape = body.tet();
    return !shape.initial_displacement.empty() && shape.initial_displacement.size() == shape.mesh.nodes.size();
  });
}

double SumOfModuli(const Material& material) {
  return std::visit([](const auto& law) { return law.ShearModulus() + law.BulkModulus(); }, material);
}

}  // namespace

TetSolver::TetSolver(const TetModel& model, ThreadTeam& team, Profile* profile)
    : model_(model), team_(team), profile_(profile), method_(model.scene().tet), contact_(model) {
  if (!IsImplicit()) return;
  const StageTimer timer(profile_, "matrix pattern");
  newton_ = std::make_unique<NewtonSolver>(model, team, profile);
  if (method_.stepping == Stepping::kNewmark) energy_correction_ = std::make_unique<EnergyCorrection>(model);
}

TetState TetSolver::InitialState(const Controls& start) {
  const StageTimer timer(profile_, "initial state");
  TetState state;
  state.positions = model_.InitialPositions();
  state.velocities = model_.InitialVelocities();
  state.contact_firmness = HasContact() ? 1 : 0;
  if (IsImplicit()) {
    state.accelerations.assign(model_.nodes(), Vec3::Zero());
    state.previous_velocities = state.velocities;
    state.previous_positions = state.positions;
    state.pressures.assign(model_.patches().size(), 0.0);
  }
  PrescribePositions(model_, start, state.positions);
  if (IsImplicit() && model_.order() == ElementOrder::kQuadratic && DisplacesCornersOnly(model_.scene())) {
    SettleMiddles(start, state);
  }
  CompleteState(start, state);
  return state;
}

// Sets what follows from the positions, and from the velocities of free components.
void TetSolver::CompleteState(const Controls& start, TetState& state) {
  PrescribeVelocities(model_, start, state.velocities);
  const ForceReport forces =
      UpdateForce(method_.stepping == Stepping::kExplicit && model_.has_strain_damping() ? &state.velocities : nullptr,
                  FibreDrive{start.activations}, start, state);
  if (method_.stepping == Stepping::kNewmark && forces.valid) SetFirstAcceleration(start, state);
  state.stable.activation.assign(start.activations.size(), 0.0);
  if (HasBranches()) state.branches = RelaxedBranches(model_, state.positions, team_, forces_);
}

// Initial displacements are those of corners. On straight edges, most of the energy would be that of mid-edge nodes out
// of place, whose vibrations no step resolves. So these start in equilibrium between the corners, which stiff springs
// hold; where there is none, edges stay straight.
void TetSolver::SettleMiddles(const Controls& start, TetState& state) {
  ExternalForce(model_, start, team_, held_load_);
  IncrementalPotential potential;
  potential.drive = FibreDrive{start.activations};
  potential.load = &held_load_;
  potential.inertia.assign(model_.nodes(), 0.0);
  potential.inertia_centre = state.positions;
  for (const TetBody& body : model_.bodies()) {
    double volume = 0;
    const std::size_t points = static_cast<std::size_t>(model_.points_per_element());
    for (std::size_t p = points * body.tet_begin; p < points * body.tet_end; ++p) volume += model_.rest_volume()[p];
    const double size = std::cbrt(volume / static_cast<double>(body.tet_end - body.tet_begin));
    const double stiffness = kHoldOfCorners * size * SumOfModuli(body.source->material);
    for (std::size_t n = body.node_begin; n < body.mesh_node_end; ++n) potential.inertia[n] = stiffness;
  }
  NodalVector x = state.positions;
  std::vector<double> pressures = state.pressures;
  if (newton_->Solve(potential, state.positions, {}, x, pressures).end != NewtonResult::End::kConverged) return;
  for (const TetBody& body : model_.bodies()) {
    for (std::size_t n = body.mesh_node_end; n < body.node_end; ++n) state.positions[n] = x[n];
  }
}

// a = M^-1 (f + loads) - a_m v. With a = 0 the first step of a released body would be of first order.
void TetSolver::SetFirstAcceleration(const Controls& start, TetState& state) {
  ExternalForce(model_, start, team_, external_next_);
  AddPositionLoads(model_, start.load_scales, state.positions, external_next_);
  for (std::size_t n = 0; n < model_.nodes(); ++n) {
    const Vec3 damping = model_.mass_damping()[n] * state.velocities[n];
    state.accelerations[n] =
        model_.inverse_mass()[n].cwiseProduct(state.force[n] + external_next_[n] - model_.mass()[n] * damping);
    state.force[n] = model_.mass()[n] * state.accelerations[n];
  }
}

StepProposal TetSolver::ProposeStep(TetState& state, const Controls& now, double end) {
  return IsImplicit() ? ProposeImplicit(state, end) : ProposeExplicit(state, now, end);
}

StepProposal TetSolver::ProposeExplicit(TetState& state, const Controls& now, double end) {
  if (IsStableStepDue(state, now)) RefreshStableStep(state, now);
  const double target = TargetStep(state);
  const double remaining = end - state.time;
  // The tolerance prevents rounding from adding a step to a whole number of them.
  const double steps = std::ceil(remaining / target * (1 - 1e-9));
  StepProposal proposal;
  if (!(steps < kMostSteps)) {
    proposal.problem = std::isnan(target) ? StepProblem::kNotFinite : StepProblem::kStepTooSmall;
    proposal.bad = FindThinnestElement(model_, state.positions);
    return proposal;
  }
  proposal.time = steps <= 1 ? end : state.time + remaining / steps;
  proposal.dt = proposal.time - state.time;
  return proposal;
}

StepReport TetSolver::Step(TetState& state, const Controls& now, const Controls& next, double dt) {
  StepReport report = Attempt(state, now, next, dt, next_);
  if (report.problem == StepProblem::kNone && !IsImplicit()) report.problem = Judge(state, next_, report);
  if (report.problem == StepProblem::kNone) {
    IsImplicit() ? AcceptImplicit(state, report, dt) : AcceptExplicit(state, report);
    return report;
  }
  report.try_shorter = CutStep(state, now, report, dt);
  if (!report.try_shorter) FindWhere(state, next, report);
  return report;
}

// Makes the next proposal shorter; false if it would be too short.
bool TetSolver::CutStep(TetState& state, const Controls& now, const StepReport& report, double dt) {
  if (IsImplicit()) return CutImplicit(state, report, dt);
  if (state.cuts >= kMaxCuts) return false;
  if (state.stable.found_at != state.step) RefreshStableStep(state, now);
  ++state.cuts;
  state.last_cut = state.step;
  return true;
}

double TetSolver::StableStepAt(const TetState& state, const Controls& now) {
  const StageTimer timer(profile_, "stable step");
  FibreDrive drive{now.activations};
  if (HasBranches()) {
    SetStepDrive(model_, state.branches, 0, team_, state_branches_);
    drive.branches = &state_branches_;
  }
  return LargestStableStep(model_, drive, state.positions, method_.stepping == Stepping::kExplicit, team_, forces_,
                           stable_step_);
}

bool TetSolver::IsStableStepDue(const TetState& state, const Controls& now) const {
  const StableStep& stable = state.stable;
  if (stable.found_at < 0 || state.step >= stable.found_at + stable.interval) return true;
  if (state.smallest_ratio < kRatioChange * stable.smallest_ratio) return true;
  for (std::size_t k = 0; k < now.activations.size(); ++k) {
    if (std::abs(now.activations[k] - stable.activation[k]) > kActivationChange) return true;
  }
  return false;
}

void TetSolver::RefreshStableStep(TetState& state, const Controls& now) {
  StableStep& stable = state.stable;
  const double before = stable.limit;
  stable.limit = StableStepAt(state, now);
  if (stable.found_at < 0) {
    stable.interval = kFirstInterval;
  } else {
    const double change = std::abs(stable.limit - before) / before;
    if (!(change < kMuchChange)) {
      stable.interval = std::max(stable.interval / 2, kShortestInterval);
    } else if (change < kLittleChange) {
      stable.interval = std::min(stable.interval * 2, kLongestInterval);
    }
  }
  stable.found_at = state.step;
  stable.smallest_ratio = state.smallest_ratio;
  stable.activation = now.activations;
}

// A fixed step that is not stable is halved until it is.
double TetSolver::TargetStep(const TetState& state) const {
  const double limit =
      state.contact_excess > 0 ? HardenedStep(state.contact_excess) * state.stable.limit : state.stable.limit;
  double step = method_.safety * limit;
  if (method_.time_step && !std::isnan(limit)) {
    step = *method_.time_step;
    while (step > limit) step /= 2;
  }
  return std::ldexp(step, -state.cuts);
}

// Decides whether a step was too long: an element is about to invert, or the motion is stiffer than the step allows.
// Exceptions are the residual motion of a body at rest, and a motion that remains too stiff at the shortest step, far
// below the stable one, where external forces change.
StepProblem TetSolver::Judge(const TetState& now, const TetState& next, const StepReport& report) const {
  if (next.smallest_ratio < kRatioChangeOfStep * now.smallest_ratio) return StepProblem::kInvertedElement;
  const bool too_stiff =
      report.stiffness_of_motion > 4 && report.kinetic > kFaintMotion * now.peak_kinetic && now.cuts < kMaxCuts;
  return too_stiff ? StepProblem::kUnstable : StepProblem::kNone;
}

void TetSolver::AcceptExplicit(TetState& state, const StepReport& report) {
  next_.peak_kinetic = std::max(state.peak_kinetic, report.kinetic);
  next_.stable = state.stable;
  next_.cuts = state.cuts;
  next_.last_cut = state.last_cut;
  if (next_.cuts > 0 && next_.step >= next_.last_cut + kGrowAfter) {
    --next_.cuts;
    next_.last_cut = next_.step;
  }
  std::swap(state, next_);
}

// Finds where a step failed: the elements that it inverted, or else the thinnest element, which limits the step.
void TetSolver::FindWhere(const TetState& state, const Controls& next, StepReport& report) const {
  if (report.problem == StepProblem::kInvertedElement) {
    report.bad = FindBadElements(model_, FibreDrive{next.activations}, next_.positions);
    if (!report.bad.elements.empty() && !report.bad.inverted) report.problem = StepProblem::kNotFinite;
  }
  if (report.bad.elements.empty()) report.bad = FindThinnestElement(model_, state.positions);
}

}  // namespace fascicle
