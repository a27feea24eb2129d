#ifndef FASCICLE_CORE_VOXEL_CONJUGATE_GRADIENT_H_
#define FASCICLE_CORE_VOXEL_CONJUGATE_GRADIENT_H_

#include <cmath>

#include "core/voxel/multigrid.h"

namespace fascicle {

struct VoxelCgResult {
  bool converged = false;
  bool curves_down = false;  // ended because A is not positive along the last direction
  int iterations = 0;
  double residual = 0;  // |r| at the end
};

// Solves A x = b by conjugate gradients [Shewchuk 1994, B3], preconditioned by a cycle of `multigrid`, starting at x.
// Stops when |r| <= goal. Fields are those of the whole mesh. The same bits for any number of threads.
//   apply(p, q)  sets q = A p, zero at prescribed components
//   r            b - A x, zero at prescribed components; on return the final residual
template <class Apply>
VoxelCgResult ConjugateGradient(ThreadTeam& team, const Apply& apply, VoxelMultigrid& multigrid, double goal,
                                int max_iterations, VoxelField<double>& r, VoxelField<double>& x) {
  VoxelField<double> p(r.nodes()), q(r.nodes());
  double size = std::sqrt(Dot(team, r, r)), rz = 0;
  VoxelCgResult result;
  while (size > goal && result.iterations < max_iterations) {
    // The cycle works in single precision on r / |r|.
    VoxelField<float>& side = multigrid.side();
    const double inverse = 1 / size;
    ForNumbers(team, r.size(), [&](std::size_t k) { side.data()[k] = static_cast<float>(inverse * r.data()[k]); });
    multigrid.Cycle(team);
    const float* const z = multigrid.result().data();
    const double rz_before = rz;
    rz = size * Dot(team, r, multigrid.result());
    const double beta = result.iterations == 0 ? 0 : rz / rz_before;
    const double of_z = size;
    ForNumbers(team, p.size(),
               [&](std::size_t k) { p.data()[k] = of_z * static_cast<double>(z[k]) + beta * p.data()[k]; });
    apply(p, q);
    const double curvature = Dot(team, p, q);
    const double alpha = rz / curvature;
    ++result.iterations;
    if (!std::isfinite(alpha)) break;
    if (curvature < 0) {
      // In the first iteration, a step along p.
      if (result.iterations == 1) ForNumbers(team, x.size(), [&](std::size_t k) { x.data()[k] += p.data()[k]; });
      result.curves_down = true;
      break;
    }
    ForNumbers(team, x.size(), [&](std::size_t k) {
      x.data()[k] += alpha * p.data()[k];
      r.data()[k] -= alpha * q.data()[k];
    });
    size = std::sqrt(Dot(team, r, r));
  }
  result.converged = size <= goal;  // false for NaN
  result.residual = size;
  return result;
}

}  // namespace fascicle

#endif  // FASCICLE_CORE_VOXEL_CONJUGATE_GRADIENT_H_
