#ifndef FASCICLE_CORE_VOXEL_DYNAMIC_SOLVER_H_
#define FASCICLE_CORE_VOXEL_DYNAMIC_SOLVER_H_

#include <stop_token>
#include <vector>

#include "core/voxel/equilibrium.h"
#include "core/voxel/model.h"
#include "core/voxel/voxel_state.h"

namespace fascicle {

struct DynamicSettings {
  double density = 0;       // > 0 [kg/m^3]
  double mass_damping = 0;  // a of C = a M, >= 0 [1/s]
  double time_step = 0;     // > 0 [s]
  double tolerance = 1e-8;  // of a step's residual, as EquilibriumSettings::tolerance [1]
  int max_iterations = 1000;
};

struct VoxelStepReport {
  EquilibriumResult iterations;
  double kinetic = 0;  // of the mean velocity of the step [J]
  double elastic = 0;  // at its end [J]
};

// Steps a body of voxels in time by
//   (K + M/dt^2 + C/(2 dt)) u_{n+1} = f + (2 M/dt^2) u_n - (M/dt^2 - C/(2 dt)) u_{n-1},  C = a M
// [Zhu, Chen & Kaufman 1998, eqs. 3-9], M lumped: rho V/8 at each corner of a voxel (the paper's rho V/3 does not
// conserve mass). Stable for any step, but it damps, because K acts at the end of the step: with every step a motion of
// angular frequency w gets (1 + (w dt)^2)^(1/2) times smaller, and its phase goes on by atan(w dt) instead of w dt.
// With large rotation K u_{n+1} is the force of rotated bricks at u_{n+1}, found by Newton's method.
//
// The levels are set up once. One thread at a time; the same bits for any number of threads, and of a state that was
// saved and loaded.
class VoxelDynamicSolver {
 public:
  // Checked input (CheckVoxelProblem, where the body may fly). The model and the team must outlive the solver.
  VoxelDynamicSolver(const VoxelModel& model, const std::vector<VoxelSupport>& supports,
                     const DynamicSettings& settings, ThreadTeam& team);

  // At time 0, displaced by `displacement` [m] and with `velocity` [m/s]; either null: zero.
  VoxelState InitialState(const VoxelField<double>* displacement = nullptr,
                          const VoxelField<double>* velocity = nullptr) const;

  // Makes one step, under forces [N] at its end (AddForces) and with prescribed components as they are in `prescribed`
  // [m] at its end; its other components are not read. A step that does not converge leaves the state as it was.
  VoxelStepReport Step(const VoxelField<double>& force, const VoxelField<double>& prescribed, VoxelState& state,
                       std::stop_token stop = {});

  // The force [N] that makes up for what the scheme leaves at a step from `before` to `now` under `force`: that of
  // supports on the body in the components that they hold, and the residual elsewhere.
  VoxelField<double> Reaction(const VoxelField<double>& force, const VoxelState& before, const VoxelState& now);

  const DynamicSettings& settings() const { return settings_; }
  // Of each node [kg].
  const std::vector<double>& mass() const { return mass_; }
  const VoxelMultigrid& multigrid() const { return equilibrium_.multigrid(); }

 private:
  const VoxelModel* model_;
  ThreadTeam* team_;
  DynamicSettings settings_;
  std::vector<double> mass_;
  VoxelEquilibrium equilibrium_;
  VoxelField<double> inertia_, next_;  // scratch
};

// The lowest natural frequency of a body [Hz], and its shape.
struct VoxelMode {
  bool converged = false;
  double frequency = 0;      // [Hz]
  VoxelField<double> shape;  // greatest displacement 1
};
// Of small motions about the undeformed shape, with components held as supports say: the least eigenvalue of
// M^-1 K by inverse iteration.
//   tolerance  of the frequency [1]
VoxelMode LowestMode(const VoxelModel& model, const std::vector<VoxelSupport>& supports, double density,
                     ThreadTeam& team, double tolerance = 1e-8);

}  // namespace fascicle

#endif  // FASCICLE_CORE_VOXEL_DYNAMIC_SOLVER_H_
