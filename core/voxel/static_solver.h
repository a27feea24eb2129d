#ifndef FASCICLE_CORE_VOXEL_STATIC_SOLVER_H_
#define FASCICLE_CORE_VOXEL_STATIC_SOLVER_H_

#include <memory>
#include <vector>

#include "core/voxel/conjugate_gradient.h"
#include "core/voxel/model.h"

namespace fascicle {

struct StaticSettings {
  double tolerance = 1e-8;  // of the residual's norm, relative to that of all forces at the start [1]
  int max_iterations = 1000;
};

struct StaticSolution {
  VoxelCgResult iterations;
  VoxelField<double> displacement;  // [m]
  VoxelField<double> reaction;      // K u - f: zero, up to the residual, but where supports hold [N]
  double energy = 0;                // u . K u / 2 [J]
};

// Equilibrium K u = f of a body of voxels, with supports that stay and loads that may change: the levels of multigrid
// are set up once. One thread at a time; the same bits for any number of threads.
class VoxelStaticSolver {
 public:
  // Checked input (CheckVoxelProblem). The model and the team must outlive the solver.
  VoxelStaticSolver(const VoxelModel& model, const std::vector<VoxelSupport>& supports, ThreadTeam& team);

  // Starts from `start`, or from zero where it is null.
  StaticSolution Solve(const VoxelLoads& loads, const StaticSettings& settings = {},
                       const VoxelField<double>* start = nullptr);

  const VoxelMultigrid& multigrid() const { return *multigrid_; }
  // All memory that the solver takes while it solves, with its model's.
  std::size_t bytes() const;

 private:
  const VoxelModel* model_;
  ThreadTeam* team_;
  std::vector<std::size_t> fixed_numbers_;  // of the fields, ascending
  std::vector<double> fixed_values_;        // of each [m]
  std::unique_ptr<VoxelMultigrid> multigrid_;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_VOXEL_STATIC_SOLVER_H_
