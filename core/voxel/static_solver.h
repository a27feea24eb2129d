#ifndef FASCICLE_CORE_VOXEL_STATIC_SOLVER_H_
#define FASCICLE_CORE_VOXEL_STATIC_SOLVER_H_

#include <vector>

#include "core/voxel/equilibrium.h"
#include "core/voxel/model.h"

namespace fascicle {

using StaticSettings = EquilibriumSettings;

struct StaticSolution {
  EquilibriumResult iterations;
  VoxelField<double> displacement;  // [m]
  VoxelField<double> reaction;      // brick forces minus f [N]: reactions, and the residual elsewhere
  double energy = 0;                // elastic [J]
};

// Equilibrium of a body of voxels. The supported nodes are fixed, loads and prescribed displacements may change; the
// multigrid levels are set up once. Not thread-safe. The same bits for any number of threads.
class VoxelStaticSolver {
 public:
  // Input must be checked (CheckVoxelProblem). The model and the team must outlive the solver.
  VoxelStaticSolver(const VoxelModel& model, const std::vector<VoxelSupport>& supports, ThreadTeam& team);

  // Solves for loads, with the supports' displacements. Starts from `start`, or from zero if it is null.
  StaticSolution Solve(const VoxelLoads& loads, const StaticSettings& settings = {},
                       const VoxelField<double>* start = nullptr);
  // Solves for nodal forces [N], with prescribed components as in `prescribed` [m] (others are not read). Starting from
  // the solution of a similar load saves iterations; with large rotation it may be the only way to converge.
  StaticSolution Solve(const VoxelField<double>& force, const VoxelField<double>& prescribed,
                       const StaticSettings& settings = {}, const VoxelField<double>* start = nullptr);

  const VoxelMultigrid& multigrid() const { return equilibrium_.multigrid(); }
  // Memory that the solver needs while it solves, including its model.
  std::size_t bytes() const;

 private:
  const VoxelModel* model_;
  ThreadTeam* team_;
  VoxelField<double> displacements_of_supports_;
  VoxelEquilibrium equilibrium_;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_VOXEL_STATIC_SOLVER_H_
