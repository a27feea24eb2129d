#ifndef FASCICLE_CORE_TET_SADDLE_SOLVERS_H_
#define FASCICLE_CORE_TET_SADDLE_SOLVERS_H_

#include <memory>

#include "core/linalg/direct_solver.h"
#include "core/linalg/flexible_gmres.h"
#include "core/linalg/mixed_precision_cg.h"
#include "core/linalg/multigrid.h"
#include "core/tet/saddle_matrix.h"

// Two solvers for a SaddleMatrix whose prescribed components are isolated:
//   K [dx; dp] = [force; volume],   force [N], volume [m^3]; force must be zero on prescribed components, and so is dx.
// Not thread-safe.
namespace fascicle {

// Factorization: exact, and decides whether there is a minimum. Time grows with the square of the size, memory with the
// power 4/3.
class DirectSaddleSolver {
 public:
  // Analyzes the sparsity pattern.
  explicit DirectSaddleSolver(const SaddleMatrix& matrix);

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
// Schur complement, S = C + B A^-1 B^T ~ C + kSchurScale diag(B diag(A)^-1 B^T). The number of iterations stays small
// because A contains a volume modulus of its own (see Volumes in README.md), so that both are well-conditioned for any
// K/mu.
class IterativeSaddleSolver {
 public:
  IterativeSaddleSolver(const TetModel& model, const SaddleMatrix& matrix);

  struct Result {
    bool ok = false;  // whether the residual, scaled by the diagonal, fell to `tolerance` times its start
    // Whether no Ritz value of the preconditioned matrix is negative. At a minimum there is none, because A is positive
    // definite or its negative directions are among the strong directions of B^T C^-1 B.
    bool is_minimum = false;
    int iterations = 0;
  };
  Result Solve(const SaddleMatrix& matrix, const NodalVector& force, std::span<const double> volume, double tolerance,
               ThreadTeam& team, NodalVector& dx, std::span<double> dp);

  // Makes later results independent of earlier ones.
  void ForgetAggregation() { multigrid_.ForgetAggregation(); }
  std::string Description() const { return multigrid_.Description(); }

 private:
  void SetScales(const SaddleMatrix& matrix);
  void Split(const Eigen::VectorXd& joint, bool times_scale, ThreadTeam& team);
  void Join(const NodalVector& x, std::span<const double> p, bool times_scale, ThreadTeam& team,
            Eigen::VectorXd& joint) const;

  Result SolveByCg(const SaddleMatrix& matrix, const NodalVector& force, double tolerance, ThreadTeam& team,
                   NodalVector& dx);

  Multigrid multigrid_;
  MixedPrecisionCg cg_;
  GmresWorkspace gmres_;
  Eigen::VectorXd scale_, joint_side_, joint_solution_;  // inverse square root of the diagonal
  std::vector<double> schur_;
  NodalVector x_, product_;
  std::vector<double> p_, volume_;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_SADDLE_SOLVERS_H_
