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
  VoxelField<double> reaction;      // forces of the bricks - f: zero, up to the residual, but where supports hold [N]
  double energy = 0;                // elastic [J]
};

// Equilibrium of a body of voxels, with supports that stay and loads and displacements of supports that may change: the
// levels of multigrid are set up once. One thread at a time; the same bits for any number of threads.
class VoxelStaticSolver {
 public:
  // Checked input (CheckVoxelProblem). The model and the team must outlive the solver.
  VoxelStaticSolver(const VoxelModel& model, const std::vector<VoxelSupport>& supports, ThreadTeam& team);

  // Under loads, supports displaced as they say. Starts from `start`, or from zero where it is null.
  StaticSolution Solve(const VoxelLoads& loads, const StaticSettings& settings = {},
                       const VoxelField<double>* start = nullptr);
  // Under forces on nodes [N], prescribed components as they are in `prescribed` [m]; its others are not read. From the
  // solution of a load that is near, fewer iterations are left (and with large rotation that may be the only way).
  StaticSolution Solve(const VoxelField<double>& force, const VoxelField<double>& prescribed,
                       const StaticSettings& settings = {}, const VoxelField<double>* start = nullptr);

  const VoxelMultigrid& multigrid() const { return equilibrium_.multigrid(); }
  // All memory that the solver takes while it solves, with its model's.
  std::size_t bytes() const;

 private:
  const VoxelModel* model_;
  ThreadTeam* team_;
  VoxelField<double> displacements_of_supports_;
  VoxelEquilibrium equilibrium_;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_VOXEL_STATIC_SOLVER_H_
