#ifndef FASCICLE_CORE_LINALG_MIXED_PRECISION_CG_H_
#define FASCICLE_CORE_LINALG_MIXED_PRECISION_CG_H_

#include "core/linalg/float_matrix.h"

namespace fascicle {

// Solves A x = b for a symmetric positive definite matrix by conjugate gradients in single precision, preconditioned by
// the diagonal blocks D, with iterative refinement: the residual is computed in double precision and solved for again
// [Higham 2002, Accuracy and Stability of Numerical Algorithms, 12]. Suits matrices with a narrow spectrum: the number
// of iterations is about half the square root of the condition number of D^-1 A times the logarithm of the wanted
// reduction. The same bits for any number of threads; not thread-safe.
class MixedPrecisionCg {
 public:
  struct Result {
    bool converged = false;   // the residual, in the norm of D^-1, fell to `tolerance` times that of b
    bool is_positive = true;  // no direction of non-positive curvature was met
    int iterations = 0;
  };
  // Takes the values of a matrix.
  void SetUp(const BlockPattern& pattern, const BlockValues& values, ThreadTeam& team) {
    matrix_.SetValues(pattern, values, team);
  }
  // Solves with the matrix of the last SetUp, which is given again for residuals. Starts from x = 0. Components that
  // are isolated in A (IsolatePrescribed) and zero in b stay zero.
  Result Solve(const BlockPattern& pattern, const BlockValues& values, const NodalVector& b, double tolerance,
               int max_iterations, ThreadTeam& team, NodalVector& x);

 private:
  double StartFrom(const NodalVector& b, ThreadTeam& team);
  bool Iterate(double goal, int max_iterations, ThreadTeam& team, Result& result);

  FloatMatrix matrix_;
  FloatField x_, r_, z_, p_, q_;
  NodalVector residual_;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_LINALG_MIXED_PRECISION_CG_H_
