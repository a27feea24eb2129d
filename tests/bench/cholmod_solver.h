#ifndef FASCICLE_TESTS_BENCH_CHOLMOD_SOLVER_H_
#define FASCICLE_TESTS_BENCH_CHOLMOD_SOLVER_H_

#include <memory>
#include <vector>

#include "condensed_matrix.h"

namespace fascicle::bench {

// CHOLMOD's supernodal L L^T of a CondensedMatrix, with METIS's ordering; single-threaded if the BLAS is.
class CholmodSolver {
 public:
  // Analyzes; the matrix must outlive the solver.
  explicit CholmodSolver(const CondensedMatrix& matrix);
  ~CholmodSolver();

  // False when the matrix is not positive definite.
  bool Factor();
  // Only after a successful Factor.
  std::vector<double> Solve(const std::vector<double>& right_side);
  // Entries of L, and operations of a factorization.
  double entries() const;
  double operations() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace fascicle::bench

#endif  // FASCICLE_TESTS_BENCH_CHOLMOD_SOLVER_H_
