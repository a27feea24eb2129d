#include "core/eulerian/solver.h"

#include <limits>

#include "core/eulerian/advection.h"
#include "core/eulerian/extrapolation.h"

namespace fascicle {
namespace {

constexpr int kBand = 4;  // layers of nodes around the solid where the map is known
// Velocities reach further than the map, which they carry.
constexpr int kVelocityBand = kBand + 2;
constexpr double kCourant = 0.4;     // of a cell, that waves go in a step
constexpr double kMostTravel = 0.5;  // of a cell, that the solid goes in a step

// The fastest small wave of a law at rest [m/s].
double WaveSpeed(const EulerianBody& body) {
  return std::visit(
      [&](const auto& law) { return std::sqrt((law.BulkModulus() + 4.0 / 3 * law.ShearModulus()) / body.density); },
      body.material);
}

std::vector<std::uint8_t> NodesInside(const EulerianBody& body, const std::vector<Vec3>& X,
                                      const std::vector<std::uint8_t>& known) {
  std::vector<std::uint8_t> inside(X.size(), 0);
  for (std::size_t n = 0; n < X.size(); ++n) inside[n] = known[n] != 0 && body.shape.Distance(X[n]) < 0 ? 1 : 0;
  return inside;
}

}  // namespace

EulerianState EulerianSolver::InitialState(const std::function<Vec3(const Vec3&)>& map,
                                           const std::function<Vec3(const Vec3&)>& velocity) const {
  const EulerianGrid& grid = body_->grid;
  EulerianState state;
  const std::size_t count = grid.node_count();
  for (std::size_t n = 0; n < count; ++n) {
    const Vec3 x = grid.NodePosition(grid.NodeAt(n));
    state.X.push_back(map ? map(x) : x);
    state.v.push_back(velocity ? velocity(x) : Vec3::Zero());
  }
  state.known = NodesInside(*body_, state.X, std::vector<std::uint8_t>(count, 1));
  // Given everywhere: only how far it counts is to be found.
  std::vector<Vec3> X = state.X;
  Extrapolate(grid, kBand, 1, *team_, state.known, X);
  return state;
}

double EulerianSolver::StableStep(const EulerianState& state) const {
  double fastest = 0, longest = 1;
  for (std::size_t n = 0; n < state.v.size(); ++n) {
    if (nodes_.mass[n] > 0) fastest = std::max(fastest, state.v[n].norm());
  }
  // Waves are as many times faster in space as the material is stretched.
  for (const std::size_t c : cells_.solid) longest = std::max(longest, cells_.F[c].norm() / std::sqrt(3.0));
  const double h = body_->grid.spacing;
  const double travel = fastest > 0 ? kMostTravel * h / fastest : std::numeric_limits<double>::infinity();
  return std::min(kCourant * h / (WaveSpeed(*body_) * longest), travel);
}

bool EulerianSolver::IsAtSide() const {
  for (const std::size_t c : cells_.solid) {
    const GridIndex at = body_->grid.CellAt(c);
    for (int axis = 0; axis < 3; ++axis) {
      if (at[axis] < 2 || at[axis] >= body_->grid.cells[axis] - 2) return true;
    }
  }
  return false;
}

EulerianReport EulerianSolver::Step(double end, EulerianState& state) {
  const EulerianGrid& grid = body_->grid;
  EulerianReport report;
  UpdateCells(*body_, state, *team_, cells_);
  report.smallest_J = cells_.smallest_J;
  report.largest_J = cells_.largest_J;
  report.left_grid = IsAtSide();
  if (!cells_.valid) report.problem = StepProblem::kInvertedElement;
  if (report.left_grid) report.problem = StepProblem::kUnstable;
  if (report.problem != StepProblem::kNone) return report;
  SetForces(*body_, state, cells_, *team_, nodes_);
  const double dt = report.dt = std::min(StableStep(state), end - state.time);

  std::vector<Vec3> v, X;
  Advect(grid, state.known, state.v, dt, state.v, *team_, v);
  std::vector<std::uint8_t> moving(v.size(), 0);
  for (std::size_t n = 0; n < v.size(); ++n) {
    moving[n] = nodes_.inside[n] | nodes_.held[n];
    if (nodes_.held[n] != 0) {
      v[n].setZero();
    } else if (nodes_.inside[n] != 0) {
      v[n] += dt / nodes_.mass[n] * nodes_.force[n];
    }
  }
  if (body_->volume != VolumeTreatment::kNone) {
    const QpReport qp = ProjectVelocity(*body_, cells_, nodes_, dt, v);
    report.minres_iterations = qp.minres_iterations.empty() ? 0 : qp.minres_iterations.back();
    if (qp.status != QpStatus::kSolved) report.problem = StepProblem::kNotSolved;
  }
  for (std::size_t n = 0; n < v.size(); ++n) {
    if (moving[n] != 0 && !v[n].allFinite()) report.problem = StepProblem::kNotFinite;
  }
  if (report.problem != StepProblem::kNone) return report;
  Extrapolate(grid, kVelocityBand, 0, *team_, moving, v);

  Advect(grid, state.known, v, dt, state.X, *team_, X);
  // The map of nodes outside that follow is their own: it goes with the volumes that their velocities were chosen for.
  std::vector<std::uint8_t> known(v.size());
  for (std::size_t n = 0; n < v.size(); ++n) {
    known[n] = nodes_.inside[n] | nodes_.held[n] | (nodes_.leaders[n].empty() ? 0 : 1);
  }
  Extrapolate(grid, kBand, 1, *team_, known, X);
  state.X = std::move(X);
  state.v = std::move(v);
  state.known = std::move(known);
  state.time = end - state.time <= dt ? end : state.time + dt;
  ++state.step;
  return report;
}

}  // namespace fascicle
