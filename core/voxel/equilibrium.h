#ifndef FASCICLE_CORE_VOXEL_EQUILIBRIUM_H_
#define FASCICLE_CORE_VOXEL_EQUILIBRIUM_H_

#include <memory>
#include <optional>
#include <stop_token>
#include <vector>

#include "core/voxel/model.h"
#include "core/voxel/multigrid.h"
#include "core/voxel/prescribed.h"
#include "core/voxel/rotated_bricks.h"

namespace fascicle {

struct EquilibriumSettings {
  // Of the residual's norm [1]. Relative to its norm where free components are zero (linear equilibrium), or to those
  // of loads and of the bricks' forces together (steps in time, large rotation); whatever the start.
  double tolerance = 1e-8;
  int max_iterations = 1000;  // of conjugate gradients, in all
  std::stop_token stop = {};  // ends early, not converged, when asked
};

struct EquilibriumResult {
  bool converged = false;
  int iterations = 0;         // of conjugate gradients, in all
  int newton_iterations = 0;  // 1 with small rotation
  double residual = 0;        // |r| at the end, relative as the tolerance is [1]
};

// Finds u with f_int(u) + D u = f + b, where f_int are the forces of the model's bricks (K u with small rotation), D is
// diagonal, not negative, the same for the components of a node, and some components of u are prescribed: equilibrium
// with D = 0, or a step in time with D and b from inertia.
//
// By conjugate gradients [Shewchuk 1994, B3] preconditioned by a cycle of multigrid; with large rotation within
// Newton's method on the energy, where they stop at directions along which the energy curves down, and a line search
// [Nocedal & Wright 2006, algorithms 7.1 and 3.1]. One thread at a time; the same bits for any number of threads,
// whatever was solved before.
class VoxelEquilibrium {
 public:
  // shift: D of each node [N/m], or empty for none. Model and team must outlive it.
  VoxelEquilibrium(const VoxelModel& model, const std::vector<VoxelSupport>& supports, std::vector<double> shift,
                   ThreadTeam& team);
  VoxelEquilibrium(const VoxelEquilibrium&) = delete;
  VoxelEquilibrium& operator=(const VoxelEquilibrium&) = delete;

  // Starts from u, whose prescribed components are to have their values. b: null for none; tolerances are relative to
  // |f|, not to |b|.
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
  // What Newton's method knows of a place.
  struct Place;
  void Visit(const VoxelField<double>& f, const VoxelField<double>* b, Place& place);
  // Moves `now` along a step by a line search, with `next` for scratch; false where nothing is lower.
  bool Move(const VoxelField<double>& f, const VoxelField<double>* b, const VoxelField<double>& step, Place& now,
            Place& next);

  const VoxelModel* model_;
  ThreadTeam* team_;
  PrescribedComponents prescribed_;
  std::vector<double> shift_;
  std::unique_ptr<VoxelMultigrid> multigrid_;  // of bricks that have not turned
  std::optional<RotatedBricks> rotated_;       // with large rotation
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_VOXEL_EQUILIBRIUM_H_
