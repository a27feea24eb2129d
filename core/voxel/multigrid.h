#ifndef FASCICLE_CORE_VOXEL_MULTIGRID_H_
#define FASCICLE_CORE_VOXEL_MULTIGRID_H_

#include <memory>
#include <string>
#include <vector>

#include "core/voxel/rigid_pieces.h"
#include "core/voxel/transfer.h"

namespace fascicle {

// A preconditioner for K of a voxel mesh, or for K + D with a diagonal D: one W-cycle of geometric multigrid. The
// voxels of the levels have 2, 4, ... times the spacing and exist wherever they contain a solid voxel.
//
// Level matrices are Galerkin products (galerkin.h), prescribed components included. Smoothers are Chebyshev
// polynomials of the matrix preconditioned by its diagonal [Adams, Brezina, Hu & Tuminaro 2003, Parallel multigrid
// smoothing, J. Comput. Phys. 188]. The coarsest level is factored. Where larger bricks would be less than 85 % solid,
// rigid pieces (rigid_pieces.h) replace them: a brick as large as a tendon is thick is too stiff in bending. The cycle
// is a fixed sequence of products, so it is a symmetric linear operator with the same bits for any number of threads.
// Single precision except for the coarsest level. Not thread-safe.
class VoxelMultigrid {
 public:
  // `fixed` refers to the mesh's nodes, empty: none; `shift`: D for each node, >= 0, empty: none, lumped on coarser
  // levels; `rotations`: of rotated bricks, or null; levels with at most `most_factored` nodes are factored. The mesh
  // must outlive the multigrid.
  static constexpr std::int32_t kMostFactored = 250;
  VoxelMultigrid(const VoxelMesh& mesh, const VoxelStiffness& stiffness, const FixedComponents& fixed, ThreadTeam& team,
                 const std::vector<double>& shift = {}, std::optional<BrickRotations<float>> rotations = std::nullopt,
                 std::int32_t most_factored = kMostFactored);
  ~VoxelMultigrid();

  // Whether the coarsest level could be factored; false for an unsupported mesh when memory is short.
  bool ok() const { return ok_; }

  // z = M r. Prescribed components count as zero in r and are zero in z.
  void Apply(const VoxelField<double>& r, ThreadTeam& team, VoxelField<double>& z);

  // The same in single precision, in place: set `side()`, call Cycle, read `result()`. The side is overwritten.
  VoxelField<float>& side();
  const VoxelField<float>& result() const;
  void Cycle(ThreadTeam& team);

  int levels() const { return static_cast<int>(levels_.size()); }
  // Whether the only level is factored.
  bool IsDirect() const { return levels() == 1 && !pieces_; }
  // For messages: "344246 + 46434 (6711 of their own) + 6749 (2541 of their own) voxels + 431 pieces".
  std::string Description() const;
  // Memory of all levels.
  std::size_t bytes() const;

 private:
  struct Level;
  void CycleFrom(std::size_t level, ThreadTeam& team);
  // Sets d of a level to the correction by the next coarser level for r.
  void CorrectByNext(std::size_t level, ThreadTeam& team);
  // The second visit of a coarser level, which makes a W-cycle of a V-cycle; it costs an eighth of this level's work.
  void ImproveBySecondCycle(std::size_t level, ThreadTeam& team);
  bool FactorCoarsest(ThreadTeam& team);
  void SolveCoarsest();

  std::vector<std::unique_ptr<Level>> levels_;
  FixedComponents fixed_;
  std::vector<std::size_t> fixed_numbers_;  // in fields of the finest level
  bool ok_ = false;
  std::unique_ptr<RigidPieces> pieces_;  // below the coarsest level, or null
  FactoredBlocks coarsest_;              // of the coarsest level, if there are no pieces
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_VOXEL_MULTIGRID_H_
