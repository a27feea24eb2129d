#ifndef FASCICLE_CORE_LINALG_LANCZOS_H_
#define FASCICLE_CORE_LINALG_LANCZOS_H_

#include <Eigen/Eigenvalues>
#include <cmath>
#include <cstdint>

#include "core/linalg/nodal_vector.h"

namespace fascicle {

// Scratch memory of LargestEigenvalue; reused by later calls.
struct LanczosWorkspace {
  NodalVector previous, current, next, scaled;
};

// A pseudorandom number in [-0.5, 0.5) that depends on `index` only [Steele et al. 2014, SplitMix64].
inline double HashedUnit(std::uint64_t index) {
  std::uint64_t z = (index + 1) * 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  z ^= z >> 31;
  return static_cast<double>(z >> 11) * 0x1p-53 - 0.5;
}

// Upper estimate of the largest eigenvalue of W A W, with A symmetric and W diagonal (components with W = 0 are left
// out), by the Lanczos method [Golub & Van Loan 2013, 10.1]: the largest Ritz value plus its residual bound. Stops when
// that bound is below `tolerance` times the value, or after kMaxLanczosSteps. The start vector depends on the node
// numbers only, so the result is a function of A and W. There is no reorthogonalization: rounding creates copies of an
// extreme eigenvalue, which do not change its value.
//   apply  apply(p, q) sets q = A p
inline constexpr int kMaxLanczosSteps = 40;

template <class Apply>
double LargestEigenvalue(ThreadTeam& team, const Apply& apply, const NodalVector& W, double tolerance,
                         LanczosWorkspace& ws) {
  using Small = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxLanczosSteps, 1>;
  using SmallMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxLanczosSteps, kMaxLanczosSteps>;
  constexpr int kFirstCheck = 8, kCheckEvery = 4;

  const std::size_t nodes = W.size();
  // Named one by one because clang 14 can't capture structured bindings.
  NodalVector& previous = ws.previous;
  NodalVector& v = ws.current;
  NodalVector& w = ws.next;
  NodalVector& scaled = ws.scaled;
  previous.assign(nodes, Vec3::Zero());
  v.resize(nodes);
  w.resize(nodes);
  scaled.resize(nodes);
  ForNodes(team, nodes, [&](std::size_t n) {
    for (int c = 0; c < 3; ++c) v[n][c] = W[n][c] == 0 ? 0 : HashedUnit(3 * n + c);
  });
  double beta = std::sqrt(Dot(team, v, v));
  if (beta == 0) return 0;
  ForNodes(team, nodes, [&](std::size_t n) { v[n] /= beta; });

  Small alphas(kMaxLanczosSteps), betas(kMaxLanczosSteps);
  double estimate = 0;
  beta = 0;
  for (int k = 0; k < kMaxLanczosSteps; ++k) {
    ForNodes(team, nodes, [&](std::size_t n) { scaled[n] = W[n].cwiseProduct(v[n]); });
    apply(scaled, w);
    ForNodes(team, nodes, [&](std::size_t n) { w[n] = W[n].cwiseProduct(w[n]) - beta * previous[n]; });
    const double alpha = Dot(team, v, w);
    ForNodes(team, nodes, [&](std::size_t n) { w[n] -= alpha * v[n]; });
    beta = std::sqrt(Dot(team, w, w));
    alphas[k] = alpha;
    betas[k] = beta;
    const int size = k + 1;
    const bool exhausted = !(beta > 1e-14 * std::abs(alpha));
    if (exhausted || size == kMaxLanczosSteps || (size >= kFirstCheck && size % kCheckEvery == 0)) {
      Eigen::SelfAdjointEigenSolver<SmallMatrix> eigen(size);
      eigen.computeFromTridiagonal(Small(alphas.head(size)), Small(betas.head(size - 1)));
      const double value = eigen.eigenvalues()[size - 1];
      const double residual = beta * std::abs(eigen.eigenvectors()(size - 1, size - 1));
      estimate = value + residual;
      if (exhausted || residual <= tolerance * std::abs(value)) break;
    }
    ForNodes(team, nodes, [&](std::size_t n) {
      previous[n] = v[n];
      v[n] = w[n] / beta;
    });
  }
  return estimate;
}

}  // namespace fascicle

#endif  // FASCICLE_CORE_LINALG_LANCZOS_H_
