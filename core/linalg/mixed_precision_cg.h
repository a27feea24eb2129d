#ifndef FASCICLE_CORE_LINALG_MIXED_PRECISION_CG_H_
#define FASCICLE_CORE_LINALG_MIXED_PRECISION_CG_H_

#include "core/linalg/float_matrix.h"

namespace fascicle {

// Solves A x = b for a symmetric positive definite matrix by conjugate gradients in single precision, preconditioned by
// the diagonal blocks D; what is left is found in double and solved for again (iterative refinement, [Higham 2002,
// Accuracy and Stability of Numerical Algorithms, 12]). For matrices whose spectrum is narrow: the number of iterations
// is about half the root of the condition of D^-1 A times the logarithm of what is wanted. The same bits for any number
// of threads; one solution at a time.
class MixedPrecisionCg {
 public:
  struct Result {
    bool converged = false;   // the residual's norm, that of D^-1, fell to `tolerance` times that of b
    bool is_positive = true;  // no direction was met along which A is not
    int iterations = 0;
  };
  // From x = 0; components that A isolates (IsolatePrescribed) and where b is zero stay zero.
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
