#ifndef FASCICLE_CORE_LINALG_FLEXIBLE_GMRES_H_
#define FASCICLE_CORE_LINALG_FLEXIBLE_GMRES_H_

#include <Eigen/Core>

#include <cmath>
#include <vector>

namespace fascicle {

// Iterations between two computations of the Ritz values.
inline constexpr int kRitzInterval = 8;

struct GmresResult {
  bool converged = false;
  int iterations = 0;
  double residual = 0;  // its norm over that of the right-hand side [1]
  // Least real part of the Ritz values, which approach the extreme eigenvalues of the preconditioned matrix first.
  double least_eigenvalue = 0;
};

// Least real part of the eigenvalues of a small matrix.
double LeastRealPart(const Eigen::MatrixXd& matrix);

// Scratch memory of FlexibleGmres; reused by later calls.
template <class Vector>
struct GmresWorkspace {
  std::vector<Vector> basis, preconditioned;
};

// Solves A x = b by flexible GMRES without restart, preconditioned from the right [Saad 1993, A flexible inner-outer
// preconditioned GMRES algorithm, SIAM J. Sci. Comput. 14].
//   space                              operations on vectors: Dot(u, v), Add(scale, v, sum), Scale(scale, v), Zero()
//   apply(v, Av), precondition(r, z)   neither needs to be symmetric; precondition may change from call to call
//   x                                  the result; the initial guess is zero
// Stops when the norm of the residual is at most `tolerance` times that of b, when a Ritz value is negative, or after
// `max_iterations`. Keeps two vectors for each iteration. The same bits for any number of threads if the operations
// have them.
template <class Space, class Vector, class Apply, class Precondition>
GmresResult FlexibleGmres(const Space& space, const Apply& apply, const Precondition& precondition, const Vector& b,
                          double tolerance, int max_iterations, Vector& x, GmresWorkspace<Vector>& ws) {
  x = space.Zero();
  GmresResult result;
  const double b_norm = std::sqrt(space.Dot(b, b));
  result.converged = b_norm == 0;
  if (!(b_norm > 0)) return result;
  ws.basis.resize(max_iterations + 1);
  ws.preconditioned.resize(max_iterations);
  ws.basis[0] = b;
  space.Scale(1 / b_norm, ws.basis[0]);
  // The Hessenberg matrix, reduced to triangular form by Givens rotations as it grows, and the rotated right-hand side.
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(max_iterations + 1, max_iterations), H_before = H;
  Eigen::VectorXd cosine(max_iterations), sine(max_iterations), side = Eigen::VectorXd::Zero(max_iterations + 1);
  side[0] = b_norm;
  int k = 0;
  for (result.residual = 1; k < max_iterations && result.residual > tolerance;) {
    precondition(ws.basis[k], ws.preconditioned[k]);
    Vector& w = ws.basis[k + 1];
    apply(ws.preconditioned[k], w);
    for (int i = 0; i <= k; ++i) {
      H(i, k) = space.Dot(w, ws.basis[i]);
      space.Add(-H(i, k), ws.basis[i], w);
    }
    const double norm = std::sqrt(space.Dot(w, w));
    if (!std::isfinite(norm)) break;
    H_before.col(k) = H.col(k);
    H_before(k + 1, k) = norm;
    for (int i = 0; i < k; ++i) {
      const double upper = cosine[i] * H(i, k) + sine[i] * H(i + 1, k);
      H(i + 1, k) = -sine[i] * H(i, k) + cosine[i] * H(i + 1, k);
      H(i, k) = upper;
    }
    const double length = std::hypot(H(k, k), norm);
    if (length == 0) break;
    cosine[k] = H(k, k) / length;
    sine[k] = norm / length;
    H(k, k) = length;
    side[k + 1] = -sine[k] * side[k];
    side[k] *= cosine[k];
    result.residual = std::abs(side[k + 1]) / b_norm;
    ++k;
    if (norm == 0) break;
    if (k % kRitzInterval == 0 && LeastRealPart(H_before.topLeftCorner(k, k)) < 0) break;
    space.Scale(1 / norm, w);
  }
  result.iterations = k;
  result.converged = result.residual <= tolerance;
  if (k == 0) return result;
  result.least_eigenvalue = LeastRealPart(H_before.topLeftCorner(k, k));
  const Eigen::VectorXd y = H.topLeftCorner(k, k).triangularView<Eigen::Upper>().solve(side.head(k));
  for (int i = 0; i < k; ++i) space.Add(y[i], ws.preconditioned[i], x);
  return result;
}

}  // namespace fascicle

#endif  // FASCICLE_CORE_LINALG_FLEXIBLE_GMRES_H_
