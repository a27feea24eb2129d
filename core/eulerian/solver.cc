#include "core/eulerian/solver.h"

#include <limits>
#include <optional>

#include "core/eulerian/advection.h"
#include "core/eulerian/extrapolation.h"
#include "core/eulerian/momentum.h"
#include "core/eulerian/plasticity.h"
#include "core/eulerian/surface.h"
#include "core/eulerian/wave_speed.h"

namespace fascicle {
namespace {

constexpr int kBand = 4;  // layers of nodes around the solid where the map is known
// Velocities reach further than the map, which they carry.
constexpr int kVelocityBand = kBand + 2;
constexpr double kCourant = 0.4;       // of a cell, that waves go in a step
constexpr double kImplicit = 10;       // times that, where elasticity is implicit
constexpr double kMostTravel = 0.5;    // of a cell, that the solid goes in a step
constexpr double kLeastStep = 1e-6;    // of that for waves at rest
constexpr double kMostSurfaceGap = 1;  // cells that the map and its surface may be apart
constexpr std::size_t kMostNamed = 16;
constexpr std::size_t kGrain = 1024;

std::vector<std::uint8_t> NodesInside(const EulerianBody& body, const std::vector<Vec3>& X) {
  std::vector<std::uint8_t> inside(X.size(), 0);
  for (std::size_t n = 0; n < X.size(); ++n) inside[n] = body.shape.Distance(X[n]) < 0 ? 1 : 0;
  return inside;
}

void StartPlasticity(const EulerianBody& body, EulerianState& state) {
  if (!body.plasticity) return;
  const EulerianGrid samples = PlasticGrid(body);
  state.plastic.assign(samples.node_count(), Mat3::Identity());
  for (std::size_t n = 0; n < samples.node_count(); ++n) {
    state.plastic_places.push_back(samples.NodePosition(samples.NodeAt(n)));
  }
}

// Points of the material go along with v, to near where the map will have them.
void Drift(const EulerianGrid& grid, const KnownField& v, double dt, ThreadTeam& team, std::vector<Vec3>& points) {
  team.For(points.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      if (const auto velocity = Interpolate(grid, v, points[k])) points[k] += dt * *velocity;
    }
  });
}

}  // namespace

EulerianState EulerianSolver::InitialState(const std::function<Vec3(const Vec3&)>& map,
                                           const std::function<Vec3(const Vec3&)>& velocity) const {
  const EulerianGrid& grid = body_->grid;
  EulerianState state;
  for (std::size_t n = 0; n < grid.node_count(); ++n) {
    const Vec3 x = grid.NodePosition(grid.NodeAt(n));
    state.X.push_back(map ? map(x) : x);
    state.v.push_back(velocity ? velocity(x) : Vec3::Zero());
  }
  state.known = Band(grid, NodesInside(*body_, state.X), kBand, *team_).Known(kBand);
  state.surface = body_->shape.surface().nodes;
  state.pressure.assign(grid.cell_count(), std::numeric_limits<double>::quiet_NaN());
  CarrySurface(*body_, *team_, state);
  StartPlasticity(*body_, state);
  return state;
}

StepLength EulerianSolver::StableStep(const EulerianState& state) const {
  double fastest = 0;
  for (std::size_t n = 0; n < state.v.size(); ++n) {
    if (nodes_.mass[n] > 0) fastest = std::max(fastest, state.v[n].norm());
  }
  const double h = body_->grid.spacing;
  StepLength step;
  step.waves = kCourant * h / FastestWave(*body_, state, cells_, *team_);
  step.stable = (body_->implicit_elasticity ? kImplicit : 1) * step.waves;
  if (body_->time_step) step.stable = std::min(step.stable, *body_->time_step);
  if (fastest > 0) step.stable = std::min(step.stable, kMostTravel * h / fastest);
  if (body_->mass_damping > 0) step.stable = std::min(step.stable, 1 / body_->mass_damping);
  return step;
}

std::vector<std::int64_t> EulerianSolver::CellsAtSide() const {
  std::vector<std::int64_t> found;
  for (const std::size_t c : cells_.solid) {
    const GridIndex at = body_->grid.CellAt(c);
    bool side = false;
    for (int axis = 0; axis < 3; ++axis) side |= at[axis] < 2 || at[axis] >= body_->grid.cells[axis] - 2;
    if (side && found.size() < kMostNamed) found.push_back(static_cast<std::int64_t>(c));
  }
  return found;
}

// What the map says of the cells, and the forces there.
StepProblem EulerianSolver::Prepare(const EulerianState& state, EulerianReport& report) {
  const StageTimer timer(profile_, "forces");
  UpdateCells(*body_, state, *team_, cells_);
  report.smallest_J = cells_.smallest_J;
  report.largest_J = cells_.largest_J;
  if (!cells_.valid) {
    for (const std::size_t c : cells_.solid) {
      const bool bad = !(cells_.J[c] > 0) || !cells_.F[c].allFinite();
      if (bad && report.bad_cells.size() < kMostNamed) report.bad_cells.push_back(static_cast<std::int64_t>(c));
    }
    return StepProblem::kInvertedElement;
  }
  report.bad_cells = CellsAtSide();
  if (!report.bad_cells.empty()) return StepProblem::kLeftGrid;
  SetForces(*body_, state, cells_, *team_, nodes_);
  return StepProblem::kNone;
}

// From carried velocities to those at the end of the step, of nodes inside and held ones; and pressures.
StepProblem EulerianSolver::Accelerate(const EulerianState& state, const StepLength& step, EulerianReport& report) {
  const double dt = step.dt;
  std::vector<Vec3>& v = next_.v;
  const StageTimer timer(profile_, "constraints");
  std::vector<Vec3> impulses(body_->supports > 0 ? v.size() : 0, Vec3::Zero());  // of the supports
  team_->For(v.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      if (nodes_.support[n] >= 0) {
        const Vec3 given = body_->support_velocity(nodes_.support[n], state.X[n], state.time, dt);
        impulses[n] = nodes_.mass[n] * (given - v[n]) - dt * nodes_.force[n];
        v[n] = given;
      } else if (nodes_.inside[n] != 0) {
        v[n] += dt / nodes_.mass[n] * nodes_.force[n];
      }
    }
  });
  next_.pressure.assign(body_->grid.cell_count(), std::numeric_limits<double>::quiet_NaN());
  if (body_->volume != VolumeTreatment::kNone || body_->implicit_elasticity) {
    const Projection projection = ProjectVelocity(*body_, state, cells_, nodes_, step, *team_, v, next_.pressure);
    const QpReport& qp = projection.report;
    report.minres_iterations = qp.minres_iterations.empty() ? 0 : qp.minres_iterations.back();
    if (qp.status != QpStatus::kSolved) return StepProblem::kVelocitiesNotFound;
    for (std::size_t n = 0; n < projection.held_impulses.size(); ++n) impulses[n] -= projection.held_impulses[n];
  }
  reactions_.assign(static_cast<std::size_t>(body_->supports), Vec3::Zero());
  for (std::size_t n = 0; n < impulses.size(); ++n) {
    if (nodes_.support[n] >= 0) reactions_[nodes_.support[n]] += impulses[n] / dt;
  }
  if (!AllFinite(v)) return StepProblem::kNotFinite;
  for (const NodalForces::Follower& follower : nodes_.followers) {
    Vec3 sum = Vec3::Zero();
    for (const NodeWeight& part : follower.leaders) sum += part.weight * v[part.node];
    if (!follower.leaders.empty()) v[follower.node] = sum;
  }
  return StepProblem::kNone;
}

// Of nodes inside and held ones.
bool EulerianSolver::AllFinite(const std::vector<Vec3>& v) const {
  return team_->Sum(v.size(), [&](std::size_t begin, std::size_t end) {
    int wrong = 0;
    for (std::size_t n = begin; n < end; ++n) {
      if ((nodes_.support[n] >= 0 || nodes_.inside[n] != 0) && !v[n].allFinite()) ++wrong;
    }
    return static_cast<double>(wrong);
  }) == 0;
}

void EulerianSolver::Carry(const std::vector<Vec3>& field, const std::vector<Vec3>& v, const EulerianState& state,
                           double dt, std::vector<Vec3>& result) {
  const Flow flow = {&body_->grid, &state.known, &v, dt};
  body_->maccormack ? AdvectMacCormack(flow, field, *team_, result) : Advect(flow, field, *team_, result);
}

// The map, the surface and what is plastic, with the velocities of nodes inside, held ones and those that follow.
StepProblem EulerianSolver::Move(const EulerianState& state, double dt) {
  const EulerianGrid& grid = body_->grid;
  std::vector<Vec3>& v = next_.v;
  std::optional<Band> band;
  {
    const StageTimer timer(profile_, "extrapolation of velocities");
    // The map of nodes outside that follow is their own: it goes with the volumes that their velocities were chosen
    // for.
    std::vector<std::uint8_t> moves(v.size());
    for (std::size_t n = 0; n < v.size(); ++n) moves[n] = nodes_.moves(n) ? 1 : 0;
    band.emplace(grid, moves, kVelocityBand, *team_);
    band->Extend(kVelocityBand, 0, *team_, v);
  }
  {
    const StageTimer timer(profile_, "advection of the map");
    Carry(state.X, v, state, dt, next_.X);
  }
  {
    const StageTimer timer(profile_, "extrapolation of the map");
    band->Extend(kBand, 1, *team_, next_.X);
    next_.known = band->Known(kBand);
  }
  {
    const StageTimer timer(profile_, "surface");
    next_.surface = state.surface;
    next_.plastic = state.plastic;
    next_.plastic_places = state.plastic_places;
    Drift(grid, {&v, &state.known}, dt, *team_, next_.surface);
    Drift(grid, {&v, &state.known}, dt, *team_, next_.plastic_places);
    if (!(CarrySurface(*body_, *team_, next_) < kMostSurfaceGap * grid.spacing)) return StepProblem::kInvertedElement;
  }
  if (body_->plasticity) {
    const StageTimer timer(profile_, "plastic flow");
    FlowPlastically(*body_, dt, *team_, next_);
  }
  return StepProblem::kNone;
}

// Gives a body that nothing holds the momentum that it should have, which is returned.
Resultant EulerianSolver::Conserve(const EulerianState& state, std::vector<Vec3>& v) const {
  if (state.momentum_mass == 0 || body_->supports > 0) return MomentumOf(body_->grid, nodes_, v, *team_);
  // Masses of cut cells are not exact, and come and go by a thousandth: velocities shall not.
  const double part = MassOf(nodes_, *team_) / state.momentum_mass;
  const Resultant wanted = {part * state.momentum, part * state.moment};
  SetMomentum(body_->grid, nodes_, wanted, state.known, *team_, v);
  return wanted;
}

EulerianReport EulerianSolver::Step(double end, EulerianState& state) {
  EulerianReport report;
  report.problem = Prepare(state, report);
  if (report.problem != StepProblem::kNone) return report;
  StepLength step = StableStep(state);
  const double left = end - state.time;
  if (!(step.stable >= kLeastStep * kCourant * body_->grid.spacing / WaveSpeedAtRest(*body_))) {
    report.problem = StepProblem::kStepTooSmall;
    return report;
  }
  // The last two steps before a frame are equally long: a very short one would upset pressures.
  step.dt = report.dt = left <= step.stable ? left : std::min(step.stable, left / 2);
  next_.time = left <= step.stable ? end : state.time + step.dt;
  next_.step = state.step + 1;
  now_ = state.v;
  const Resultant momentum = Conserve(state, now_), force = ForceOf(body_->grid, nodes_, *team_);
  {
    const StageTimer timer(profile_, "advection of velocities");
    Carry(now_, now_, state, step.dt, next_.v);
  }
  report.problem = Accelerate(state, step, report);
  if (report.problem == StepProblem::kNone) report.problem = Move(state, step.dt);
  if (report.problem != StepProblem::kNone) return report;
  next_.momentum_mass = MassOf(nodes_, *team_);
  next_.momentum = momentum.sum + step.dt * force.sum;
  next_.moment = momentum.moment + step.dt * force.moment;
  std::swap(state, next_);
  return report;
}

}  // namespace fascicle
