#ifndef FASCICLE_CORE_LINALG_MULTIGRID_H_
#define FASCICLE_CORE_LINALG_MULTIGRID_H_

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/linalg/aggregation.h"
#include "core/linalg/direct_solver.h"
#include "core/linalg/sweep_matrix.h"

namespace fascicle {

// A preconditioner for symmetric matrices of elasticity: one V-cycle of multigrid.
//
// Coarser levels are Galerkin products P^T A P. The caller may give the first interpolation (from the corners of
// quadratic elements to all of their nodes); all others are found by smoothed aggregation with rigid body modes
// (aggregation.h). The coarsest level is factored. The smoothers are Gauss-Seidel sweeps of 3x3 blocks, forward before
// and backward after the coarser level, so that the cycle is a symmetric linear operator; it is positive where the
// coarsest matrix is [Trottenberg, Oosterlee & Schueller 2001, Multigrid, A.2]. The sweeps visit the rows in an order
// that threads can share (SweepOrder): the same bits for any number of threads. All levels but the coarsest are in
// single precision. Not thread-safe.
class Multigrid {
 public:
  // `positions` [m] are those of the finest level's nodes. The pattern must outlive the multigrid.
  Multigrid(const BlockPattern& pattern, const NodalVector& positions, const FreeComponents& free,
            std::optional<Prolongation> first);
  ~Multigrid();

  // Takes the values of the finest level, with prescribed components isolated. The aggregation is found at the first
  // call after construction or ForgetAggregation and kept; all values are new. False when the coarsest level can't be
  // factored.
  bool SetUp(const BlockValues& values, ThreadTeam& team);

  // Makes the next SetUp independent of everything before it.
  void ForgetAggregation();

  // The finest level's matrix, whose order the fields of Apply have.
  const SweepMatrix& finest() const;
  // z = M r; both have the finest level's size.
  void Apply(const FloatField& r, ThreadTeam& team, FloatField& z);

  // Sizes of all levels, for messages: "17300 + 2673 blocks".
  std::string Description() const;

 private:
  struct Level;
  bool HasCoarser(std::size_t level) const;
  void AddLevel(const BlockValues& values, ThreadTeam& team);
  bool FactorCoarsest(const BlockValues& values);
  void Cycle(std::size_t level, const FloatField& b, ThreadTeam& team, FloatField& x);
  void SolveCoarsest(const FloatField& b, FloatField& x);

  std::vector<std::unique_ptr<Level>> levels_;
  DirectSolver coarsest_;
  bool first_is_given_ = false, coarsest_analyzed_ = false;
  std::vector<double> coarsest_values_, coarsest_side_;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_LINALG_MULTIGRID_H_
