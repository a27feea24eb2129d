#ifndef FASCICLE_CORE_LINALG_CONJUGATE_GRADIENT_H_
#define FASCICLE_CORE_LINALG_CONJUGATE_GRADIENT_H_

#include <algorithm>

#include "core/linalg/nodal_vector.h"

namespace fascicle {

// Scratch memory of ConjugateGradient; reused by later calls.
struct CgWorkspace {
  NodalVector residual, preconditioned, direction, product;

  void Resize(std::size_t nodes) {
    residual.resize(nodes);
    preconditioned.resize(nodes);
    direction.resize(nodes);
    product.resize(nodes);
  }
};

struct CgResult {
  bool converged = false;
  int iterations = 0;
};

// Solves A x = b for symmetric positive definite A by Jacobi-preconditioned conjugate gradients [Shewchuk 1994, B3].
//   apply             apply(p, q) sets q = A p
//   inverse_diagonal  1 / A_ii; zero marks a prescribed component, which keeps its value in x
//   x                 start and result
// Stops when the norm of the residual (weighted by the inverse diagonal) is at most `tolerance` times the larger one of
// the norms of b and of the initial residual. The same bits for any number of threads. Allocates nothing once the
// workspace has its size.
template <class Apply>
CgResult ConjugateGradient(ThreadTeam& team, const Apply& apply, const NodalVector& inverse_diagonal,
                           const NodalVector& b, double tolerance, int max_iterations, NodalVector& x,
                           CgWorkspace& ws) {
  const std::size_t nodes = b.size();
  ws.Resize(nodes);
  // Named one by one because clang 14 can't capture structured bindings.
  NodalVector& r = ws.residual;
  NodalVector& z = ws.preconditioned;
  NodalVector& p = ws.direction;
  NodalVector& q = ws.product;
  apply(x, q);
  ForNodes(team, nodes, [&](std::size_t n) {
    r[n] = b[n] - q[n];
    p[n] = z[n] = inverse_diagonal[n].cwiseProduct(r[n]);
  });
  const double b_norm =
      SumOverNodes(team, nodes, [&](std::size_t n) { return inverse_diagonal[n].dot(b[n].cwiseAbs2()); });
  double rz = Dot(team, r, z);
  const double goal = tolerance * tolerance * std::max(b_norm, rz);
  CgResult result;
  for (; rz > goal && result.iterations < max_iterations; ++result.iterations) {
    apply(p, q);
    const double alpha = rz / Dot(team, p, q);
    ForNodes(team, nodes, [&](std::size_t n) {
      x[n] += alpha * p[n];
      r[n] -= alpha * q[n];
      z[n] = inverse_diagonal[n].cwiseProduct(r[n]);
    });
    const double rz_before = rz;
    rz = Dot(team, r, z);
    const double beta = rz / rz_before;
    ForNodes(team, nodes, [&](std::size_t n) { p[n] = z[n] + beta * p[n]; });
  }
  result.converged = rz <= goal;  // false for NaN
  return result;
}

}  // namespace fascicle

#endif  // FASCICLE_CORE_LINALG_CONJUGATE_GRADIENT_H_
