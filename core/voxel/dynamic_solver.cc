#include "core/voxel/dynamic_solver.h"

#include <algorithm>
#include <cmath>

#include "core/linalg/lanczos.h"
#include "core/voxel/static_solver.h"

namespace fascicle {
namespace {

constexpr int kMostInverseIterations = 200;

std::vector<double> LumpedMass(const VoxelMesh& mesh, double density) {
  std::vector<double> mass(mesh.nodes(), 0);
  const double share = density * mesh.spacing().prod() / 8;
  ForVoxels(mesh, [&](std::int32_t, const GridIndex&, const std::array<std::int32_t, 8>& nodes) {
    for (const std::int32_t node : nodes) mass[node] += share;
  });
  return mass;
}

std::vector<double> Times(double factor, std::vector<double> values) {
  for (double& value : values) value *= factor;
  return values;
}

// v . M v.
double MassProduct(ThreadTeam& team, const std::vector<double>& mass, const VoxelField<double>& v) {
  return SumOverNodes(team, mass.size(),
                      [&](std::size_t n) { return mass[n] * v.At(static_cast<std::int32_t>(n)).squaredNorm(); });
}

// M/dt^2 + C/(2 dt) over M.
double ShiftOf(const DynamicSettings& s) {
  return 1 / (s.time_step * s.time_step) + s.mass_damping / (2 * s.time_step);
}

}  // namespace

VoxelDynamicSolver::VoxelDynamicSolver(const VoxelModel& model, const std::vector<VoxelSupport>& supports,
                                       const DynamicSettings& settings, ThreadTeam& team)
    : model_(&model),
      team_(&team),
      settings_(settings),
      mass_(LumpedMass(model.mesh(), settings.density)),
      equilibrium_(model, supports, Times(ShiftOf(settings), mass_), team),
      inertia_(model.mesh().nodes()),
      next_(model.mesh().nodes()) {}

VoxelState VoxelDynamicSolver::InitialState(const VoxelField<double>* displacement,
                                            const VoxelField<double>* velocity) const {
  const VoxelField<double> zero(model_->mesh().nodes());
  VoxelState state;
  state.displacement = state.previous = displacement != nullptr ? *displacement : zero;
  if (velocity == nullptr) return state;
  for (std::size_t k = 0; k < velocity->size(); ++k) {
    state.previous.data()[k] -= settings_.time_step * velocity->data()[k];
  }
  return state;
}

VoxelStepReport VoxelDynamicSolver::Step(const VoxelField<double>& force, const VoxelField<double>& prescribed,
                                         VoxelState& state) {
  const double dt = settings_.time_step;
  const double of_now = 2 / (dt * dt), of_previous = 1 / (dt * dt) - settings_.mass_damping / (2 * dt);
  ForNodes(*team_, mass_.size(), [&](std::size_t n) {
    for (int d = 0; d < 3; ++d) {
      const double now = state.displacement.component(d)[n], previous = state.previous.component(d)[n];
      inertia_.component(d)[n] = mass_[n] * (of_now * now - of_previous * previous);
      next_.component(d)[n] = now + (now - previous);
    }
  });
  equilibrium_.prescribed().Copy(prescribed, next_);
  VoxelStepReport report;
  report.iterations = equilibrium_.Solve(
      force, &inertia_, {.tolerance = settings_.tolerance, .max_iterations = settings_.max_iterations}, next_);
  state.iterations += report.iterations.iterations;
  if (!report.iterations.converged) return report;
  report.elastic = equilibrium_.InternalForces(next_, inertia_);
  ForNumbers(*team_, next_.size(),
             [&](std::size_t k) { inertia_.data()[k] = (next_.data()[k] - state.displacement.data()[k]) / dt; });
  report.kinetic = 0.5 * MassProduct(*team_, mass_, inertia_);
  std::swap(state.previous, state.displacement);
  std::swap(state.displacement, next_);
  ++state.step;
  state.time = static_cast<double>(state.step) * dt;
  return report;
}

VoxelField<double> VoxelDynamicSolver::Reaction(const VoxelField<double>& force, const VoxelState& before,
                                                const VoxelState& now) {
  const double dt = settings_.time_step, a = settings_.mass_damping;
  VoxelField<double> reaction(model_->mesh().nodes());
  equilibrium_.InternalForces(now.displacement, reaction);
  ForNodes(*team_, mass_.size(), [&](std::size_t n) {
    for (int d = 0; d < 3; ++d) {
      const double next = now.displacement.component(d)[n], present = before.displacement.component(d)[n],
                   previous = before.previous.component(d)[n];
      reaction.component(d)[n] +=
          mass_[n] * ((next - 2 * present + previous) / (dt * dt) + a * (next - previous) / (2 * dt)) -
          force.component(d)[n];
    }
  });
  return reaction;
}

VoxelMode LowestMode(const VoxelModel& model, const std::vector<VoxelSupport>& supports, double density,
                     ThreadTeam& team, double tolerance) {
  const std::vector<double> mass = LumpedMass(model.mesh(), density);
  VoxelEquilibrium equilibrium(model, supports, {}, team);
  const std::int32_t nodes = model.mesh().nodes();
  VoxelMode mode;
  VoxelField<double>& v = mode.shape;
  v = VoxelField<double>(nodes);
  for (int d = 0; d < 3; ++d) {
    for (std::int32_t n = 0; n < nodes; ++n) v(n, d) = HashedUnit(3 * static_cast<std::uint64_t>(n) + d);
  }
  equilibrium.prescribed().Clear(v);
  VoxelField<double> Mv(nodes), w(nodes);
  double eigenvalue = 0;
  for (int i = 0; i < kMostInverseIterations && !mode.converged; ++i) {
    const double scale = 1 / std::sqrt(MassProduct(team, mass, v));
    ForNodes(team, mass.size(), [&](std::size_t n) {
      for (int d = 0; d < 3; ++d) {
        v.component(d)[n] *= scale;
        Mv.component(d)[n] = mass[n] * v.component(d)[n];
        // K w = M v has the solution w ~ v / eigenvalue.
        w.component(d)[n] = eigenvalue > 0 ? v.component(d)[n] / eigenvalue : 0;
      }
    });
    if (!equilibrium.Solve(Mv, nullptr, {.tolerance = 0.01 * tolerance}, w).converged) return mode;
    // Rayleigh quotient of w: w.K w = w.M v.
    const double next = Dot(team, w, Mv) / MassProduct(team, mass, w);
    mode.converged = std::abs(next - eigenvalue) <= 2 * tolerance * next;
    eigenvalue = next;
    std::swap(v, w);
  }
  mode.frequency = std::sqrt(eigenvalue) / (2 * EIGEN_PI);
  double largest = 0;
  for (std::int32_t n = 0; n < nodes; ++n) largest = std::max(largest, v.At(n).norm());
  for (std::size_t k = 0; k < v.size(); ++k) v.data()[k] /= largest;
  return mode;
}

}  // namespace fascicle
