// Work during a step: of loads and gravity, of supports, and of activation.
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/tet/floor_contact.h"
#include "core/tet/solver.h"

namespace fascicle {
namespace {

// A state is out of balance if its largest free force exceeds this part of the largest force.
constexpr double kOutOfBalance = 1e-4;

// Places from 0 to 1 and weights of the rule with five points, exact for polynomials of degree 7.
struct LobattoPoint {
  double place, weight;
};
constexpr double kInner = 0.32732683535398857190;  // sqrt(3/7) / 2
constexpr LobattoPoint kLobatto[] = {
    {0, 1. / 20}, {0.5 - kInner, 49. / 180}, {0.5, 16. / 45}, {0.5 + kInner, 49. / 180}, {1, 1. / 20}};

// Calls call(node, component) for every prescribed component.
template <class Call>
void ForPrescribed(const TetModel& model, const Call& call) {
  for (const Support& support : model.supports()) {
    for (std::size_t i = 0; i < support.nodes.size(); ++i) {
      for (int c = 0; c < 3; ++c) {
        if (support.owned[i][c]) call(static_cast<std::size_t>(support.nodes[i]), c);
      }
    }
  }
}

bool SupportsMove(const TetModel& model, const NodalVector& from, const NodalVector& to) {
  bool move = false;
  ForPrescribed(model, [&](std::size_t n, int c) { move |= from[n][c] != to[n][c]; });
  return move;
}

double Product(ThreadTeam& team, const NodalVector& a, const NodalVector& b) {
  return SumOverNodes(team, a.size(), [&](std::size_t n) { return a[n].dot(b[n]); });
}

bool IsBalanced(const TetModel& model, const NodalVector& internal, const NodalVector& external) {
  double residual = 0, largest = 0;
  for (std::size_t n = 0; n < model.nodes(); ++n) {
    const Vec3 free = model.mass()[n] * model.inverse_mass()[n];
    residual = std::max(residual, free.cwiseProduct(internal[n] + external[n]).norm());
    largest = std::max({largest, internal[n].norm(), external[n].norm()});
  }
  return residual <= kOutOfBalance * largest;
}

}  // namespace

void TetSolver::AddWork(const TetState& now, const StepControls& step, TetState& next) {
  const StageTimer timer(profile_, "external work");
  next.load_work = now.load_work;
  next.external_work = now.external_work;
  next.activation_work = now.activation_work;
  double of_loads = 0;
  if (model_.has_gravity() || !model_.loads().empty()) {
    of_loads = 0.5 * SumOverNodes(team_, model_.nodes(), [&](std::size_t n) {
                 return (external_now_[n] + external_next_[n]).dot(next.positions[n] - now.positions[n]);
               });
    next.load_work += of_loads;
  }
  if (method_.stepping == Stepping::kQuasiStatic) {
    AddStaticWork(now, step, of_loads, next);
    return;
  }
  next.external_work += of_loads;
  if (HasContact()) next.external_work += WorkOfRigidBodies(now, step, next);
  if (SupportsMove(model_, now.positions, next.positions)) next.external_work += DynamicWorkOfSupports(now, step, next);
}

// The force of supports is m a less all other forces: the change of kinetic energy of prescribed components, less the
// work of the other forces on them by the trapezoidal rule.
double TetSolver::DynamicWorkOfSupports(const TetState& now, const StepControls& step, const TetState& next) {
  const NodalVector *from = &now.force, *to = &next.force;
  if (IsImplicit()) {
    force_before_ = InternalForce(StateDrive(now, step.now.activations), now, step.now);
    force_after_ = InternalForce(DriveOf(now, step), next, step.next);
    from = &force_before_;
    to = &force_after_;
  }
  const bool add_viscous = method_.stepping != Stepping::kExplicit && model_.has_strain_damping();
  if (add_viscous) {
    mean_rate_.resize(model_.nodes());
    for (std::size_t n = 0; n < mean_rate_.size(); ++n) {
      mean_rate_[n] = (next.positions[n] - now.positions[n]) / step.dt;
    }
    ViscousForce(model_, next.positions, mean_rate_, team_, forces_, viscous_);
  }
  double work = 0;
  ForPrescribed(model_, [&](std::size_t n, int c) {
    const double moved = next.positions[n][c] - now.positions[n][c];
    const double before = now.velocities[n][c], after = next.velocities[n][c];
    double force = 0.5 * ((*from)[n][c] + external_now_[n][c] + (*to)[n][c] + external_next_[n][c]);
    if (add_viscous) force += viscous_[n][c];
    const double damping = model_.mass_damping()[n] * model_.mass()[n] * moved / step.dt;
    work += 0.5 * model_.mass()[n] * (after * after - before * before) + (damping - force) * moved;
  });
  return work;
}

FibreDrive TetSolver::StateDrive(const TetState& state, std::span<const double> activations) {
  FibreDrive drive(activations, nullptr, 0);
  if (!HasBranches()) return drive;
  SetStateDrive(model_, state.branches, team_, state_branches_);
  drive.branches = &state_branches_;
  return drive;
}

NodalVector TetSolver::ElasticAndFloorForce(const FibreDrive& drive, const NodalVector& x) {
  NodalVector force;
  ElasticForce(model_, drive, x, team_, forces_, force);
  AddFloorForce(model_, x, force);
  return force;
}

NodalVector TetSolver::InternalForce(const FibreDrive& drive, const TetState& state, const Controls& controls) {
  NodalVector force = ElasticAndFloorForce(drive, state.positions);
  if (HasContact()) AddContactForce(TouchesAt(state, controls), force);
  return force;
}

// By the mean of the forces at both ends; of a step whose contact forces are exact, by these.
double TetSolver::WorkOfRigidBodies(const TetState& now, const StepControls& step, const TetState& next) {
  const Placements from = PlacementsOf(model_, step.now), to = PlacementsOf(model_, step.next);
  const double before = fascicle::WorkOfRigidBodies(TouchesAt(now, step.now), from, to, from);
  const std::vector<Touch>& touches = method_.stepping == Stepping::kNewmark
                                          ? contact_.Find(contact_drive_, next.positions, team_)
                                          : TouchesAt(next, step.next);
  return 0.5 * (before + fascicle::WorkOfRigidBodies(touches, from, to, to));
}

// Energy is a function of positions and activations, so the work along any path between two equilibria is its change.
// Along the straight path, which Lobatto's rule integrates, external forces and activation together do that work. Their
// own parts by the trapezoidal rule differ from it in the third order of the step, because states on the path are not
// in equilibrium; this difference belongs to what drives the step.
void TetSolver::AddStaticWork(const TetState& now, const StepControls& step, double of_loads, TetState& next) {
  const std::vector<double>&a0 = step.now.activations, &a1 = step.next.activations;
  NodalVector moved(model_.nodes()), x(model_.nodes()), at_start, at_end;
  for (std::size_t n = 0; n < moved.size(); ++n) moved[n] = next.positions[n] - now.positions[n];
  std::vector<double> a(a0.size());
  double along_path = 0, activation = 0;
  for (const auto& [place, weight] : kLobatto) {
    for (std::size_t n = 0; n < x.size(); ++n) x[n] = now.positions[n] + place * moved[n];
    for (std::size_t k = 0; k < a.size(); ++k) a[k] = a0[k] + place * (a1[k] - a0[k]);
    NodalVector force = ElasticAndFloorForce(FibreDrive{a}, x);
    along_path -= weight * Product(team_, force, moved);
    // Energy is linear in activation.
    if (a0 != a1) activation += weight * (ElasticEnergyAt(FibreDrive{a1}, x) - ElasticEnergyAt(FibreDrive{a0}, x));
    if (place == 0) at_start = force;
    if (place == 1) at_end = std::move(force);
  }
  // The work on branches is part of neither energy nor activation; external forces do it, too.
  if (HasBranches()) {
    at_start = ElasticAndFloorForce(StateDrive(now, a0), now.positions);
    at_end = ElasticAndFloorForce(StateDrive(next, a1), next.positions);
    along_path += next.dissipated - now.dissipated;
  }
  double by_rigid_bodies = 0;
  if (HasContact()) {
    along_path -= ContactEnergy(TouchesAt(now, step.now));
    AddContactForce(contact_.touches(), at_start);
    along_path += ContactEnergy(TouchesAt(next, step.next));
    AddContactForce(contact_.touches(), at_end);
    by_rigid_bodies = WorkOfRigidBodies(now, step, next);
  }
  // What external forces do, by the trapezoidal rule.
  double boundary = of_loads + by_rigid_bodies;
  ForPrescribed(model_, [&](std::size_t n, int c) {
    const double sum = at_start[n][c] + external_now_[n][c] + at_end[n][c] + external_next_[n][c];
    boundary -= 0.5 * sum * moved[n][c];
  });
  // Where an element is inverted on the way, only the trapezoidal rule is left.
  const bool defined = std::isfinite(along_path) && std::isfinite(activation);
  if (!defined) along_path = boundary;
  if (!defined) activation = 0;
  const bool by_activation = boundary == 0 || (activation != 0 && IsBalanced(model_, at_start, external_now_));
  next.external_work += by_activation ? boundary : along_path;
  next.activation_work += by_activation ? activation + along_path - boundary : activation;
}

double TetSolver::ElasticEnergyAt(const FibreDrive& drive, const NodalVector& x) {
  double sum = 0;
  for (std::size_t b = 0; b < model_.bodies().size(); ++b) sum += ElasticEnergy(model_, b, drive, x, team_);
  return sum;
}

}  // namespace fascicle
