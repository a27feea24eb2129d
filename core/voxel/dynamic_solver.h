#ifndef FASCICLE_CORE_VOXEL_DYNAMIC_SOLVER_H_
#define FASCICLE_CORE_VOXEL_DYNAMIC_SOLVER_H_

#include <vector>

#include "core/voxel/equilibrium.h"
#include "core/voxel/model.h"
#include "core/voxel/voxel_state.h"

namespace fascicle {

struct DynamicSettings {
  double density = 0;       // > 0 [kg/m^3]
  double mass_damping = 0;  // a in C = a M, >= 0 [1/s]
  double time_step = 0;     // > 0 [s]
  double tolerance = 1e-8;  // for a step's residual, see EquilibriumSettings::tolerance [1]
  int max_iterations = 1000;
};

struct VoxelStepReport {
  EquilibriumResult iterations;
  double kinetic = 0;  // for the mean velocity of the step [J]
  double elastic = 0;  // at the end of the step [J]
};

// Steps a body of voxels in time by
//   (K + M/dt^2 + C/(2 dt)) u_{n+1} = f + (2 M/dt^2) u_n - (M/dt^2 - C/(2 dt)) u_{n-1},  C = a M
// [Zhu, Chen & Kaufman 1998, eqs. 3-9], M lumped: rho V/8 at each corner of a voxel (the paper's rho V/3 does not
// conserve mass). Unconditionally stable, but dissipative, because K acts at the end of the step: in every step a mode
// of angular frequency w decreases by a factor of (1 + (w dt)^2)^(1/2), and its phase advances by atan(w dt) instead of
// w dt. With large rotation, K u_{n+1} is replaced by the force of rotated bricks at u_{n+1}, and the step is solved by
// Newton's method.
//
// The levels are set up once. Not thread-safe. The same bits for any number of threads, and for a state that was saved
// and loaded.
class VoxelDynamicSolver {
 public:
  // Input must be checked (CheckVoxelProblem with may_fly). The model and the team must outlive the solver.
  VoxelDynamicSolver(const VoxelModel& model, const std::vector<VoxelSupport>& supports,
                     const DynamicSettings& settings, ThreadTeam& team);

  // The state at time 0 with `displacement` [m] and `velocity` [m/s]; null means zero.
  VoxelState InitialState(const VoxelField<double>* displacement = nullptr,
                          const VoxelField<double>* velocity = nullptr) const;

  // Makes one step under the nodal forces [N] at its end (AddForces), with prescribed components as in `prescribed` [m]
  // at its end (other components are not read). A step that does not converge leaves the state unchanged.
  VoxelStepReport Step(const VoxelField<double>& force, const VoxelField<double>& prescribed, VoxelState& state);

  // The force [N] that balances the scheme in a step from `before` to `now` under `force`: the reactions in prescribed
  // components, and the residual elsewhere.
  VoxelField<double> Reaction(const VoxelField<double>& force, const VoxelState& before, const VoxelState& now);

  const DynamicSettings& settings() const { return settings_; }
  // Mass of each node [kg].
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

// The lowest natural frequency of a body [Hz] and its mode shape.
struct VoxelMode {
  bool converged = false;
  double frequency = 0;      // [Hz]
  VoxelField<double> shape;  // scaled to a largest displacement of 1
};
// For small motions about the undeformed shape, with components prescribed by the supports: the least eigenvalue of
// M^-1 K, by inverse iteration.
//   tolerance  of the frequency [1]
VoxelMode LowestMode(const VoxelModel& model, const std::vector<VoxelSupport>& supports, double density,
                     ThreadTeam& team, double tolerance = 1e-8);

}  // namespace fascicle

#endif  // FASCICLE_CORE_VOXEL_DYNAMIC_SOLVER_H_
