#ifndef FASCICLE_CORE_LINALG_MULTIGRID_H_
#define FASCICLE_CORE_LINALG_MULTIGRID_H_

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/linalg/aggregation.h"
#include "core/linalg/direct_solver.h"
#include "core/linalg/float_matrix.h"

namespace fascicle {

// A preconditioner for symmetric matrices of elasticity: one V-cycle of multigrid.
//
// Coarser levels are made by Galerkin products P^T A P, the first with an interpolation that the caller may know (from
// the corners of quadratic elements to all of their nodes), all others by smoothed aggregation with the rigid body
// modes (aggregation.h); the coarsest is factored. Smoothing is by Chebyshev polynomials of the matrix preconditioned
// by its 3x3 diagonal blocks [Adams, Brezina, Hu & Tuminaro 2003, Parallel multigrid smoothing, J. Comput. Phys. 188]:
// a fixed sequence of products, so the cycle is a symmetric linear operator, and the bits are the same for any number
// of threads. Levels are kept in single precision but for the coarsest. One thread at a time.
class Multigrid {
 public:
  // Nodes of the finest level are at `positions` [m]; the pattern must outlive the multigrid.
  Multigrid(const BlockPattern& pattern, const NodalVector& positions, const FreeComponents& free,
            std::optional<Prolongation> first);
  ~Multigrid();

  // Values of the finest level, prescribed components isolated. The aggregation is found at the first call after
  // construction or ForgetAggregation and kept, all numbers are new. False when the coarsest level can't be factored.
  // `least_eigenvalue`: a bound from below for the matrix preconditioned by its diagonal blocks, 0 where there is none;
  // where it is near enough to the largest, smoothing alone does, and there are no coarser levels.
  bool SetUp(const BlockValues& values, ThreadTeam& team, double least_eigenvalue = 0);

  // The next SetUp starts anew: what follows does not depend on what was before.
  void ForgetAggregation();

  // z = M r; both of the finest level's size.
  void Apply(const NodalVector& r, ThreadTeam& team, NodalVector& z);

  // Sizes of all levels, for people: "17300 + 2673 blocks".
  std::string Description() const;

 private:
  struct Level;
  bool HasCoarser(std::size_t level) const;
  void AddLevel(const BlockValues& values);
  bool FactorCoarsest(const BlockValues& values);
  void Cycle(std::size_t level, ThreadTeam& team);
  void SolveCoarsest();

  std::vector<std::unique_ptr<Level>> levels_;
  DirectSolver coarsest_;
  bool smoothes_only_ = false;
  bool first_is_given_ = false, coarsest_analyzed_ = false;
  std::vector<double> coarsest_values_, coarsest_side_;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_LINALG_MULTIGRID_H_
