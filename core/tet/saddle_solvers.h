#ifndef FASCICLE_CORE_TET_SADDLE_SOLVERS_H_
#define FASCICLE_CORE_TET_SADDLE_SOLVERS_H_

#include <memory>
#include <stop_token>

#include "core/linalg/direct_solver.h"
#include "core/linalg/flexible_gmres.h"
#include "core/linalg/mixed_precision_cg.h"
#include "core/linalg/multigrid.h"
#include "core/tet/float_saddle.h"

// Two solvers for a SaddleMatrix whose prescribed components are isolated:
//   K [dx; dp] = [force; volume],   force [N], volume [m^3]; force must be zero on prescribed components, and so is dx.
// Not thread-safe.
namespace fascicle {

// Factorization: exact, and decides whether there is a minimum. Time grows with the square of the size, memory with the
// power 4/3.
class DirectSaddleSolver {
 public:
  // Analyzes the sparsity pattern. Calls of a large system throw Stopped after a stop request.
  explicit DirectSaddleSolver(const SaddleMatrix& matrix, const std::stop_token& stop = {});

  // False if the matrix can't be factored or its inertia is not that of a minimum, which has as many negative
  // eigenvalues as there are patches.
  bool Factor(const SaddleMatrix& matrix);
  void Solve(const NodalVector& force, std::span<const double> volume, NodalVector& dx, std::span<double> dp);

 private:
  template <class Visit>
  void ForEntries(const SaddleMatrix& matrix, const Visit& visit) const;

  std::vector<std::array<std::int32_t, 3>> unknown_of_node_;  // -1: prescribed
  std::int32_t node_unknowns_ = 0;
  DirectSolver solver_;
  std::vector<double> values_, side_;
};

// Flexible GMRES: memory and time of an iteration grow linearly with the size. The preconditioner is block triangular
// [Elman, Silvester & Wathen 2014, 4.2 and 9.2]: a multigrid cycle approximates A^-1, and a diagonal approximates the
// Schur complement, S = C + B A^-1 B^T ~ C + 4 diag(B diag(A)^-1 B^T). The number of iterations stays small because A
// contains a volume modulus of its own (see Volumes in README.md), so that both are well-conditioned for any K/mu.
// Iterations are in single precision, with refinement: the residual is computed in double precision and, if it is not
// small enough, solved for again [Higham 2002, Accuracy and Stability of Numerical Algorithms, 12].
class IterativeSaddleSolver {
 public:
  IterativeSaddleSolver(const TetModel& model, const SaddleMatrix& matrix);

  // Takes the values of a matrix.
  void SetUp(const SaddleMatrix& matrix, ThreadTeam& team);

  struct Result {
    bool ok = false;  // whether the residual, scaled by the diagonal, fell to `tolerance` times its start
    // Whether no Ritz value of the preconditioned matrix is negative. At a minimum there is none, because A is positive
    // definite or its negative directions are among the strong directions of B^T C^-1 B.
    bool is_minimum = false;
    int iterations = 0;
  };
  // Solves with the matrix of the last SetUp.
  Result Solve(const SaddleMatrix& matrix, const NodalVector& force, std::span<const double> volume, double tolerance,
               ThreadTeam& team, NodalVector& dx, std::span<double> dp);

  // Makes later results independent of earlier ones.
  void ForgetAggregation() { multigrid_.ForgetAggregation(); }
  std::string Description() const { return multigrid_.Description(); }

 private:
  static bool SuitsCg(const SaddleMatrix& matrix);
  Result SolveByCg(const SaddleMatrix& matrix, const NodalVector& force, double tolerance, ThreadTeam& team,
                   NodalVector& dx);
  GmresResult Iterate(double tolerance, int max_iterations, ThreadTeam& team);

  bool is_set_up_ = false;  // whether multigrid_ is
  Multigrid multigrid_;
  FloatSaddle saddle_;
  MixedPrecisionCg cg_;
  GmresWorkspace<SaddleField> gmres_;
  SaddleField side_, solution_;
  FloatField force_;
  NodalVector residual_;
  std::vector<double> volume_residual_;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_SADDLE_SOLVERS_H_
