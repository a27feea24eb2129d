#ifndef FASCICLE_CORE_LINALG_MINRES_H_
#define FASCICLE_CORE_LINALG_MINRES_H_

#include <Eigen/Core>

#include <cmath>

namespace fascicle {

struct MinresResult {
  bool converged = false;
  int iterations = 0;
  double residual = 0;  // |r| over |b|, both in the norm of the preconditioner [1]
};

// Solves A x = b for symmetric A, definite or indefinite, by the minimal residual method [Paige & Saunders 1975],
// preconditioned [Elman, Silvester & Wathen 2014, algorithm 4.1], from x = 0. Stops when sqrt(r . P r) <= tolerance *
// sqrt(b . P b). If A is singular and b is in its range, finds a solution with the least residual. The same input gives
// the same bits. Runs on the calling thread.
//   apply(x, y)  sets y = A x
//   precondition(r, z)  sets z = P r, P symmetric positive definite
template <class Apply, class Precondition>
MinresResult Minres(const Apply& apply, const Precondition& precondition, const Eigen::VectorXd& b, double tolerance,
                    int max_iterations, Eigen::VectorXd& x) {
  const Eigen::Index size = b.size();
  const auto zero = [size] { return Eigen::VectorXd::Zero(size).eval(); };
  x = zero();
  Eigen::VectorXd v_before = zero(), v = b, v_next(size), z(size), z_next(size);
  Eigen::VectorXd w_before = zero(), w = zero(), w_next(size);
  precondition(v, z);
  double gamma_before = 1, gamma = std::sqrt(z.dot(v));
  const double start = gamma;
  double eta = gamma, sine_before = 0, sine = 0, cosine_before = 1, cosine = 1;
  MinresResult result;
  result.converged = start == 0;
  result.residual = start == 0 ? 0 : 1;
  while (!result.converged && result.iterations < max_iterations && std::isfinite(eta)) {
    z /= gamma;
    apply(z, v_next);
    const double delta = z.dot(v_next);
    v_next -= (delta / gamma) * v + (gamma / gamma_before) * v_before;
    precondition(v_next, z_next);
    const double gamma_next = std::sqrt(std::max(z_next.dot(v_next), 0.0));
    const double a0 = cosine * delta - cosine_before * sine * gamma;
    const double a1 = std::hypot(a0, gamma_next);
    const double a2 = sine * delta + cosine_before * cosine * gamma;
    const double a3 = sine_before * gamma;
    ++result.iterations;
    if (a1 == 0) break;  // b is not in the range of A
    cosine_before = cosine;
    sine_before = sine;
    cosine = a0 / a1;
    sine = gamma_next / a1;
    w_next = (z - a3 * w_before - a2 * w) / a1;
    x += cosine * eta * w_next;
    eta *= -sine;
    result.residual = std::abs(eta) / start;
    result.converged = result.residual <= tolerance;
    if (gamma_next == 0) break;  // the Krylov space is exhausted
    std::swap(v_before, v);
    std::swap(v, v_next);
    std::swap(z, z_next);
    std::swap(w_before, w);
    std::swap(w, w_next);
    gamma_before = gamma;
    gamma = gamma_next;
  }
  return result;
}

}  // namespace fascicle

#endif  // FASCICLE_CORE_LINALG_MINRES_H_
