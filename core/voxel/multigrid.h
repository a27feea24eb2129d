#ifndef FASCICLE_CORE_VOXEL_MULTIGRID_H_
#define FASCICLE_CORE_VOXEL_MULTIGRID_H_

#include <memory>
#include <string>
#include <vector>

#include "core/voxel/rigid_pieces.h"
#include "core/voxel/transfer.h"

namespace fascicle {

// A preconditioner for K of a voxel mesh, or for K + D with a diagonal D: one W-cycle of geometric multigrid over
// voxels of twice, four times, ... the spacing, wherever there is any solid voxel in them.
//
// Stiffness of the levels by Galerkin products (galerkin.h), prescribed components included; smoothing by Chebyshev
// polynomials of the matrix preconditioned by its diagonal [Adams, Brezina, Hu & Tuminaro 2003, Parallel multigrid
// smoothing, J. Comput. Phys. 188]; the coarsest level factored. Where larger bricks would be solid by less than 85 %,
// rigid pieces (rigid_pieces.h) take their place: a brick as large as a tendon is thick is too stiff in bending. A
// fixed sequence of products, so the cycle is a symmetric linear operator, the same bits for any number of threads.
// Single precision but for the coarsest. One thread at a time.
class VoxelMultigrid {
 public:
  // `fixed` of the mesh's nodes, empty for none; `shift`: D of each node, >= 0, empty for none, lumped on coarser
  // levels; `rotations`: how bricks have turned, if they have; levels of up to `most_factored` nodes are factored. The
  // mesh must outlive the multigrid.
  static constexpr std::int32_t kMostFactored = 250;
  VoxelMultigrid(const VoxelMesh& mesh, const VoxelStiffness& stiffness, const FixedComponents& fixed, ThreadTeam& team,
                 const std::vector<double>& shift = {}, std::optional<BrickRotations<float>> rotations = std::nullopt,
                 std::int32_t most_factored = kMostFactored);
  ~VoxelMultigrid();

  // Whether the coarsest level could be factored: not where nothing holds the mesh and memory is short.
  bool ok() const { return ok_; }

  // z = M r. Components that are fixed are taken for zero in r, and are zero in z.
  void Apply(const VoxelField<double>& r, ThreadTeam& team, VoxelField<double>& z);

  // The same in single precision, in place: set `side()`, call Cycle, read `result()`; the side is lost.
  VoxelField<float>& side();
  const VoxelField<float>& result() const;
  void Cycle(ThreadTeam& team);

  int levels() const { return static_cast<int>(levels_.size()); }
  // Whether there is nothing but a factorization.
  bool IsDirect() const { return levels() == 1 && !pieces_; }
  // For people: "344246 + 46434 (6711 of their own) + 6749 (2541 of their own) voxels + 431 pieces".
  std::string Description() const;
  // Memory of all levels.
  std::size_t bytes() const;

 private:
  struct Level;
  void CycleFrom(std::size_t level, ThreadTeam& team);
  // Sets d of a level from what the level below makes of r.
  void CorrectByNext(std::size_t level, ThreadTeam& team);
  // What makes a W-cycle of a V-cycle: the level below goes on from its result. It costs an eighth of this level's
  // work.
  void ImproveBySecondCycle(std::size_t level, ThreadTeam& team);
  bool FactorCoarsest(ThreadTeam& team);
  void SolveCoarsest();

  std::vector<std::unique_ptr<Level>> levels_;
  FixedComponents fixed_;
  std::vector<std::size_t> fixed_numbers_;  // of the finest fields
  bool ok_ = false;
  std::unique_ptr<RigidPieces> pieces_;  // below the coarsest level, or null
  FactoredBlocks coarsest_;              // of the coarsest level, where there are no pieces
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_VOXEL_MULTIGRID_H_
