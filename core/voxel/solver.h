#ifndef FASCICLE_CORE_VOXEL_SOLVER_H_
#define FASCICLE_CORE_VOXEL_SOLVER_H_

#include <cstdint>
#include <memory>
#include <vector>

#include "core/base/archive.h"
#include "core/base/profile.h"
#include "core/base/step_problem.h"
#include "core/voxel/dynamic_solver.h"
#include "core/voxel/scene_body.h"
#include "core/voxel/static_solver.h"

namespace fascicle {

// Everything that changes from step to step, which is what a checkpoint saves.
struct VoxelSceneState {
  double time = 0;  // [s]
  std::int64_t step = 0;
  double time_step = 0;         // of the last step [s]
  std::int64_t iterations = 0;  // of conjugate gradients so far
  std::vector<VoxelState> bodies;
  // For each body at `time`: elastic and kinetic energy [J], and what each support does to it, along the world axes.
  std::vector<double> elastic, kinetic;
  std::vector<std::vector<Reaction>> reactions;

  void Save(ArchiveWriter& archive) const;
  void Load(ArchiveReader& archive);
};

struct VoxelSolveReport {
  StepProblem problem = StepProblem::kNone;
  std::size_t body = 0;  // the body with the problem
  double residual = 0;   // the largest of all bodies at the end, relative as the tolerance [1]
};

// Steps the bodies of a scene by the voxel method [Zhu, Chen & Kaufman 1998]. Not thread-safe. All functions may throw
// Stopped (core/base/stop.h), which leaves states unchanged.
class VoxelSolver {
 public:
  // CheckScene and CheckVoxelSupports must have accepted the scene. Scene, team and profile must outlive the solver.
  VoxelSolver(const Scene& scene, ThreadTeam& team, Profile* profile = nullptr);

  const std::vector<std::unique_ptr<VoxelSceneBody>>& bodies() const { return bodies_; }

  // The state at time 0, at rest. Call SolveStart next.
  VoxelSceneState InitialState() const;

  // Finds the equilibrium at time 0 if the scene asks for it (statics, `start_loaded`). start: the controls at time 0.
  VoxelSolveReport SolveStart(VoxelSceneState& state, const Controls& start);

  // The next step towards `end` [s], the time of the next frame. Static: the whole interval. Dynamic: an equal part of
  // the frame interval that is no longer than the scene's time step.
  StepProposal ProposeStep(const VoxelSceneState& state, double end) const;

  // Makes a step of dt [s] to the time of `next`. dt must be that of ProposeStep: the levels of the dynamic method
  // are built for one length. If it fails, the state is unchanged.
  VoxelSolveReport Step(VoxelSceneState& state, const Controls& next, double dt);

 private:
  VoxelSolveReport SolveStatic(VoxelSceneState& state, const Controls& next);
  VoxelSolveReport StepDynamic(VoxelSceneState& state, const Controls& next);
  VoxelStaticSolver& StaticSolverOf(std::size_t body);

  const Scene& scene_;
  ThreadTeam& team_;
  Profile* const profile_;
  std::int64_t steps_per_frame_ = 1;
  std::vector<std::unique_ptr<VoxelSceneBody>> bodies_;
  std::vector<std::unique_ptr<VoxelStaticSolver>> static_solvers_;
  std::vector<std::unique_ptr<VoxelDynamicSolver>> dynamic_solvers_;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_VOXEL_SOLVER_H_
