#include "core/eulerian/body_stepper.h"

#include <Eigen/Geometry>

#include <limits>
#include <optional>

#include "core/eulerian/advection.h"
#include "core/eulerian/extrapolation.h"
#include "core/eulerian/plasticity.h"
#include "core/eulerian/surface.h"
#include "core/eulerian/wave_speed.h"

namespace fascicle {
namespace {

constexpr int kBand = 4;  // layers of nodes around the solid where the map is extrapolated
// Velocities are extrapolated further than the map, because they advect it.
constexpr int kVelocityBand = kBand + 2;
constexpr double kCourant = 0.4;  // fraction of a cell that waves travel in a step
constexpr double kImplicit = 10;  // factor on that for implicit elasticity
// The same for bodies whose grid travels. While they fly they hardly deform, and nothing needs shorter steps.
constexpr double kImplicitTravelling = 300;
constexpr double kMostTravel = 0.5;    // fraction of a cell that the solid moves through the grid in a step
constexpr double kMostTurn = 0.1;      // angle by which a grid turns in a step [rad]
constexpr double kLeastStep = 1e-6;    // relative to the step for waves at rest
constexpr double kMostSurfaceGap = 1;  // largest distance between the map and its surface [cells]
constexpr std::size_t kMostNamed = 16;
constexpr std::size_t kStepGrain = 1024;

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

}  // namespace

EulerianState BodyStepper::InitialState(const std::function<Vec3(const Vec3&)>& map,
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
  state.reactions.assign(body_->supports.size(), Vec3::Zero());
  state.moments = state.reactions;
  FindSurface(*body_, *team_, state);
  StartPlasticity(*body_, state);
  return state;
}

StepProblem BodyStepper::Prepare(const EulerianState& state, const BodyControls& now,
                                 std::vector<std::int64_t>& bad_cells) {
  const StageTimer timer(profile_, "forces");
  frame_ = GridFrame(state.pose, body_->travels);
  UpdateCells(*body_, state, *team_, cells_);
  if (!cells_.valid) {
    for (const std::size_t c : cells_.solid) {
      const bool bad = !(cells_.J[c] > 0) || !cells_.F[c].allFinite();
      if (bad && bad_cells.size() < kMostNamed) bad_cells.push_back(static_cast<std::int64_t>(c));
    }
    return StepProblem::kInvertedElement;
  }
  bad_cells = CellsAtSide();
  if (!bad_cells.empty()) return StepProblem::kLeftGrid;
  SetForces(*body_, state, now, cells_, *team_, roles_, forces_);
  if (body_->travels) rigid_ = RigidPartOf(body_->grid, forces_, state.v, *team_);
  return StepProblem::kNone;
}

double BodyStepper::FastestBeside(const std::vector<Vec3>& v, const RigidVelocity& rigid) const {
  double fastest = 0;
  for (std::size_t n = 0; n < v.size(); ++n) {
    if (forces_.mass[n] == 0) continue;
    fastest = std::max(fastest, (v[n] - rigid.At(body_->grid.NodePosition(body_->grid.NodeAt(n)))).norm());
  }
  return fastest;
}

std::vector<std::int64_t> BodyStepper::CellsAtSide() const {
  std::vector<std::int64_t> found;
  for (const std::size_t c : cells_.solid) {
    const GridIndex at = body_->grid.CellAt(c);
    bool side = false;
    for (int axis = 0; axis < 3; ++axis) side |= at[axis] < 2 || at[axis] >= body_->grid.cells[axis] - 2;
    if (side && found.size() < kMostNamed) found.push_back(static_cast<std::int64_t>(c));
  }
  return found;
}

StepLength BodyStepper::FindStepLength(const EulerianState& state, const BodyControls& now) {
  const double fastest = FastestBeside(state.v, rigid_), spin = rigid_.spin.norm();
  const double h = body_->grid.spacing;
  StepLength step;
  waves_ = step.waves = kCourant * h / FastestWave(*body_, state, now, cells_, *team_);
  step.stable = (body_->implicit_elasticity ? body_->travels ? kImplicitTravelling : kImplicit : 1) * step.waves;
  if (spin > 0) step.stable = std::min(step.stable, kMostTurn / spin);
  if (body_->time_step) step.stable = std::min(step.stable, *body_->time_step);
  if (fastest > 0) step.stable = std::min(step.stable, kMostTravel * h / fastest);
  if (body_->mass_damping > 0) step.stable = std::min(step.stable, 1 / body_->mass_damping);
  return step;
}

double BodyStepper::LeastStep() const { return kLeastStep * kCourant * body_->grid.spacing / WaveSpeedAtRest(*body_); }

void BodyStepper::AdvectVelocities(const EulerianState& state, double dt) {
  now_ = state.v;
  const Resultant momentum = Conserve(state, now_), force = ForceOf(body_->grid, forces_, *team_);
  made_.momentum = momentum.sum + dt * force.sum;
  made_.moment = momentum.moment + dt * force.moment;
  const StageTimer timer(profile_, "advection of velocities");
  if (body_->travels) {
    AdvectField(now_, ThroughGrid(now_, rigid_), state, dt, made_.v);
  } else {
    AdvectField(now_, now_, state, dt, made_.v);
  }
}

// The velocities of the material through a grid that moves rigidly.
std::vector<Vec3> BodyStepper::ThroughGrid(const std::vector<Vec3>& v, const RigidVelocity& rigid) const {
  std::vector<Vec3> result(v.size());
  team_->For(v.size(), kStepGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n)
      result[n] = v[n] - rigid.At(body_->grid.NodePosition(body_->grid.NodeAt(n)));
  });
  return result;
}

// Restores the momentum of an unsupported body; returns that momentum.
Resultant BodyStepper::Conserve(const EulerianState& state, std::vector<Vec3>& v) const {
  if (state.momentum_mass == 0 || !body_->supports.empty()) return MomentumOf(body_->grid, forces_, v, *team_);
  // Masses of cut cells are inaccurate and vary by a thousandth from step to step; velocities must not vary with them.
  const double part = MassOf(forces_, *team_) / state.momentum_mass;
  const Resultant wanted = {part * state.momentum, part * state.moment};
  SetMomentum(body_->grid, forces_, wanted, state.known, *team_, v);
  return wanted;
}

void BodyStepper::Accelerate(const EulerianState& state, const BodyControls& now, const BodyControls& next, double dt) {
  std::vector<Vec3>& v = made_.v;
  impulses_.assign(body_->supports.empty() ? 0 : v.size(), Vec3::Zero());
  team_->For(v.size(), kStepGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      if (roles_.IsPrescribed(n)) {
        const RigidMotion& from = now.motions[roles_.support[n]];
        const RigidMotion& to = next.motions[roles_.support[n]];
        const Vec3 prescribed = frame_.VectorInGrid((to.PositionOf(state.X[n]) - from.PositionOf(state.X[n])) / dt);
        impulses_[n] = forces_.mass[n] * (prescribed - v[n]) - dt * forces_.force[n];
        v[n] = prescribed;
      } else if (roles_.inside[n] != 0) {
        v[n] += dt / forces_.mass[n] * forces_.force[n];
      }
    }
  });
  made_.pressure.assign(body_->grid.cell_count(), std::numeric_limits<double>::quiet_NaN());
}

VelocityProgram::Part BodyStepper::PartOf(const EulerianState& state, const BodyControls& now) const {
  return {body_, &state, &now, &cells_, &roles_, &forces_, &made_.v, waves_};
}

void BodyStepper::TakeVelocities(const VelocityProgram& program, std::size_t body) {
  program.TakeBody(body, made_.v, made_.pressure, impulses_);
  const Resultant impulse = program.ContactImpulse(body);
  made_.momentum += impulse.sum;
  made_.moment += impulse.moment;
}

StepProblem BodyStepper::FinishVelocities(double dt) {
  std::vector<Vec3>& v = made_.v;
  made_.reactions.assign(body_->supports.size(), Vec3::Zero());
  made_.moments = made_.reactions;
  for (std::size_t n = 0; n < impulses_.size(); ++n) {
    if (!roles_.IsPrescribed(n)) continue;
    const Vec3 force = frame_.VectorInWorld(impulses_[n] / dt);
    const Vec3 place = frame_.PointInWorld(body_->grid.NodePosition(body_->grid.NodeAt(n)));
    made_.reactions[roles_.support[n]] += force;
    made_.moments[roles_.support[n]] += place.cross(force);
  }
  if (!AllFinite(v)) return StepProblem::kNotFinite;
  for (const NodeRoles::Constrained& constrained : roles_.constrained) {
    Vec3 sum = Vec3::Zero();
    for (const NodeWeight& root : constrained.roots) sum += root.weight * v[root.node];
    if (!constrained.roots.empty()) v[constrained.node] = sum;
  }
  return StepProblem::kNone;
}

// Whether the velocities of free and prescribed nodes are finite.
bool BodyStepper::AllFinite(const std::vector<Vec3>& v) const {
  return team_->Sum(v.size(), [&](std::size_t begin, std::size_t end) {
    int wrong = 0;
    for (std::size_t n = begin; n < end; ++n) {
      if ((roles_.IsPrescribed(n) || roles_.inside[n] != 0) && !v[n].allFinite()) ++wrong;
    }
    return static_cast<double>(wrong);
  }) == 0;
}

void BodyStepper::AdvectField(const std::vector<Vec3>& field, const std::vector<Vec3>& v, const EulerianState& state,
                              double dt, std::vector<Vec3>& result) {
  const Flow flow = {&body_->grid, &state.known, &v, dt};
  body_->maccormack ? AdvectMacCormack(flow, field, *team_, result) : Advect(flow, field, *team_, result);
}

// Moves material points with v, to near their position on the next map.
void BodyStepper::AdvectPoints(const std::vector<Vec3>& velocity, const EulerianState& state, double dt,
                               std::vector<Vec3>& points) {
  const KnownField v = {&velocity, &state.known};
  team_->For(points.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      if (const auto of_point = Interpolate(body_->grid, v, points[k])) points[k] += dt * *of_point;
    }
  });
}

StepProblem BodyStepper::Move(const EulerianState& state, const BodyControls& next, double dt) {
  const EulerianGrid& grid = body_->grid;
  const std::optional<RigidVelocity> rigid =
      body_->travels ? std::optional(RigidPartOf(grid, forces_, made_.v, *team_)) : std::nullopt;
  std::vector<Vec3>& v = made_.v;
  std::optional<Band> band;
  {
    const StageTimer timer(profile_, "extrapolation of velocities");
    // Constrained nodes keep their own map: it is advected with the velocities for which the volumes were computed.
    std::vector<std::uint8_t> has_velocity(v.size());
    for (std::size_t n = 0; n < v.size(); ++n) has_velocity[n] = roles_.HasVelocity(n) ? 1 : 0;
    band.emplace(grid, has_velocity, kVelocityBand, *team_);
    band->Extend(kVelocityBand, 0, *team_, v);
  }
  std::vector<Vec3> relative;
  if (rigid) relative = ThroughGrid(v, *rigid);
  const std::vector<Vec3>& flow = rigid ? relative : v;
  {
    const StageTimer timer(profile_, "advection of the map");
    AdvectField(state.X, flow, state, dt, made_.X);
  }
  {
    const StageTimer timer(profile_, "extrapolation of the map");
    band->Extend(kBand, 1, *team_, made_.X);
    made_.known = band->Known(kBand);
  }
  {
    const StageTimer timer(profile_, "surface");
    made_.surface = state.surface;
    made_.plastic = state.plastic;
    made_.plastic_places = state.plastic_places;
    AdvectPoints(flow, state, dt, made_.surface);
    AdvectPoints(flow, state, dt, made_.plastic_places);
    if (!(FindSurface(*body_, *team_, made_) < kMostSurfaceGap * grid.spacing)) return StepProblem::kInvertedElement;
  }
  if (body_->plasticity) {
    const StageTimer timer(profile_, "plastic flow");
    FlowPlastically(*body_, next, dt, *team_, made_);
  }
  made_.momentum_mass = MassOf(forces_, *team_);
  made_.pose = state.pose;
  if (rigid) Travel(*rigid, dt);
  return StepProblem::kNone;
}

// Moves the grid with a rigid velocity: the centre of mass along a line, turning at a constant rate. Velocities and
// momenta, which this does not change in the world, get components along the new axes; so Coriolis and centrifugal
// forces need no terms of their own [Fan 2013, 4.3].
void BodyStepper::Travel(const RigidVelocity& rigid, double dt) {
  const Mat3 before = RotationOf(made_.pose);
  const double angle = dt * rigid.spin.norm();
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(angle, angle > 0 ? rigid.spin.normalized() : Vec3::UnitX()));
  const Vec3 centre = made_.pose.position + before * (rigid.centre + dt * rigid.linear);
  made_.pose = PoseAt(made_.pose.position, (QuaternionOf(made_.pose) * turn).normalized());
  const Mat3 after = RotationOf(made_.pose), turned = after.transpose() * before;
  const Vec3 position = centre - after * rigid.centre;
  team_->For(made_.v.size(), kStepGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) made_.v[n] = turned * made_.v[n];
  });
  const Vec3 shift = before.transpose() * (made_.pose.position - position);
  made_.moment = turned * (made_.moment + shift.cross(made_.momentum));
  made_.momentum = turned * made_.momentum;
  made_.pose.position = position;
}

}  // namespace fascicle
