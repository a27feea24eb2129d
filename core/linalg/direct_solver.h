#ifndef FASCICLE_CORE_LINALG_DIRECT_SOLVER_H_
#define FASCICLE_CORE_LINALG_DIRECT_SOLVER_H_

#include <cstdint>
#include <memory>
#include <span>
#include <stop_token>

namespace fascicle {

// Factorization L D L^T of a sparse symmetric matrix, definite or indefinite, by MUMPS's multifrontal method with
// pivoting [Amestoy, Duff, L'Excellent & Koster 2001]. The pattern is analyzed once; values may change. Not
// thread-safe. Because the library has global state, calls of different solvers wait for each other up to 6,000
// unknowns (tenths of a second); beyond, each solver has a process of its own (SolverProcess).
//
// The same input gives the same bits in any process, for any number of threads, on processors for which OpenBLAS has
// the same kernels. Those for AVX-512 (SkylakeX, Cooperlake) add in a different order than those for AVX2 (Haswell,
// Zen).
class DirectSolver {
 public:
  // Calls for more than 6,000 unknowns throw Stopped after a stop request, and std::bad_alloc if their process was
  // ended.
  explicit DirectSolver(std::stop_token stop = {});
  ~DirectSolver();
  DirectSolver(const DirectSolver&) = delete;
  DirectSolver& operator=(const DirectSolver&) = delete;

  // Entries (rows[k], columns[k]) of one triangle, diagonal included, counted from 0, without duplicates; size >= 1.
  // False if memory runs out.
  bool Analyze(std::int32_t size, std::span<const std::int32_t> rows, std::span<const std::int32_t> columns);

  struct Factored {
    bool ok = false;                   // false: singular to working precision, or out of memory
    std::int32_t negative_pivots = 0;  // equals the number of negative eigenvalues [Sylvester's law of inertia]
  };
  // values[k] belongs to the k-th entry of Analyze, which must have succeeded.
  Factored Factor(std::span<const double> values);

  // Replaces b by A^-1 b. Requires a successful Factor.
  void Solve(std::span<double> b);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_LINALG_DIRECT_SOLVER_H_
