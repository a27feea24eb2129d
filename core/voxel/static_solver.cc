#include "core/voxel/static_solver.h"

namespace fascicle {

VoxelStaticSolver::VoxelStaticSolver(const VoxelModel& model, const std::vector<VoxelSupport>& supports,
                                     ThreadTeam& team)
    : model_(&model),
      team_(&team),
      displacements_of_supports_(DisplacementsOf(model.mesh(), supports)),
      equilibrium_(model, supports, {}, team) {}

StaticSolution VoxelStaticSolver::Solve(const VoxelLoads& loads, const StaticSettings& settings,
                                        const VoxelField<double>* start) {
  VoxelField<double> f(model_->mesh().nodes());
  AddForces(*model_, loads, f);
  return Solve(f, displacements_of_supports_, settings, start);
}

StaticSolution VoxelStaticSolver::Solve(const VoxelField<double>& force, const VoxelField<double>& prescribed,
                                        const StaticSettings& settings, const VoxelField<double>* start) {
  StaticSolution solution;
  VoxelField<double>& u = solution.displacement;
  u = start != nullptr ? *start : VoxelField<double>(model_->mesh().nodes());
  equilibrium_.prescribed().Copy(prescribed, u);
  solution.iterations = equilibrium_.Solve(force, nullptr, settings, u);
  solution.reaction = VoxelField<double>(u.nodes());
  solution.energy = equilibrium_.InternalForces(u, solution.reaction);
  ForNumbers(*team_, force.size(), [&](std::size_t k) { solution.reaction.data()[k] -= force.data()[k]; });
  return solution;
}

std::size_t VoxelStaticSolver::bytes() const {
  return equilibrium_.bytes() + displacements_of_supports_.size() * sizeof(double);
}

}  // namespace fascicle
