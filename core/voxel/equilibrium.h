#ifndef FASCICLE_CORE_VOXEL_EQUILIBRIUM_H_
#define FASCICLE_CORE_VOXEL_EQUILIBRIUM_H_

#include <memory>
#include <optional>
#include <vector>

#include "core/voxel/model.h"
#include "core/voxel/multigrid.h"
#include "core/voxel/prescribed.h"
#include "core/voxel/rotated_bricks.h"

namespace fascicle {

struct EquilibriumSettings {
  // Of the residual's norm [1], relative to the residual with zero free components (linear equilibrium), or to the sum
  // of loads and brick forces (dynamics, large rotation), whatever the start.
  double tolerance = 1e-8;
  int max_iterations = 1000;  // of conjugate gradients, in total
};

struct EquilibriumResult {
  bool converged = false;
  int iterations = 0;         // of conjugate gradients, in total
  int newton_iterations = 0;  // 1 with small rotation
  double residual = 0;        // final |r|, relative as for the tolerance [1]
};

// Solves f_int(u) + D u = f + b for u, where f_int are the forces of the model's bricks (K u with small rotation), D is
// a non-negative diagonal, equal for the components of a node, and some components of u are prescribed: equilibrium
// with D = 0, or a time step with D and b from inertia.
//
// Conjugate gradients [Shewchuk 1994, B3] preconditioned by a multigrid cycle. With large rotation, Newton's method on
// the energy with a line search, where conjugate gradients stop at directions of negative curvature [Nocedal & Wright
// 2006, algorithms 7.1 and 3.1]. Not thread-safe. The same bits for any number of threads, whatever was solved before.
class VoxelEquilibrium {
 public:
  // shift: D for each node [N/m]; empty: D = 0. Model and team must outlive the object.
  VoxelEquilibrium(const VoxelModel& model, const std::vector<VoxelSupport>& supports, std::vector<double> shift,
                   ThreadTeam& team);
  VoxelEquilibrium(const VoxelEquilibrium&) = delete;
  VoxelEquilibrium& operator=(const VoxelEquilibrium&) = delete;

  // Starts from u, whose prescribed components must already have their values. b may be null; tolerances are relative
  // to |f|, not to |b|.
  EquilibriumResult Solve(const VoxelField<double>& f, const VoxelField<double>* b, const EquilibriumSettings& settings,
                          VoxelField<double>& u);

  // Forces of the bricks [N], and their elastic energy [J].
  double InternalForces(const VoxelField<double>& u, VoxelField<double>& f_int);

  const PrescribedComponents& prescribed() const { return prescribed_; }
  const VoxelMultigrid& multigrid() const { return *multigrid_; }
  std::size_t bytes() const;

 private:
  EquilibriumResult SolveLinear(const VoxelField<double>& f, const VoxelField<double>* b,
                                const EquilibriumSettings& settings, VoxelField<double>& u);
  EquilibriumResult SolveRotated(const VoxelField<double>& f, const VoxelField<double>* b,
                                 const EquilibriumSettings& settings, VoxelField<double>& u);
  double SizeOfTerms(const VoxelField<double>& u) const;
  // A point of Newton's method: displacements, residual, rotations and energy.
  struct Place;
  void Visit(const VoxelField<double>& f, const VoxelField<double>* b, Place& place);
  // Line search along a step from `now`, with `next` as scratch. False if the energy does not decrease.
  bool Move(const VoxelField<double>& f, const VoxelField<double>* b, const VoxelField<double>& step, Place& now,
            Place& next);

  const VoxelModel* model_;
  ThreadTeam* team_;
  PrescribedComponents prescribed_;
  std::vector<double> shift_;
  std::unique_ptr<VoxelMultigrid> multigrid_;  // of unrotated bricks
  std::optional<RotatedBricks> rotated_;       // with large rotation
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_VOXEL_EQUILIBRIUM_H_
