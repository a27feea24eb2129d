#ifndef FASCICLE_CORE_VOXEL_CONJUGATE_GRADIENT_H_
#define FASCICLE_CORE_VOXEL_CONJUGATE_GRADIENT_H_

#include <cmath>
#include <vector>

#include "core/voxel/multigrid.h"

namespace fascicle {

struct VoxelCgResult {
  bool converged = false;
  int iterations = 0;
  double residual = 0;  // |r| over |r| at the start [1]
};

// Solves K x = b for the components that are free by conjugate gradients [Shewchuk 1994, B3], preconditioned by a cycle
// of `multigrid`. Prescribed components keep the value they have in x: b and x are those of the whole mesh. Ends when
// |r| is at most `tolerance` times |r| at the start. The same bits for any number of threads.
//   fixed_numbers  numbers in the fields that are prescribed
inline VoxelCgResult SolveVoxels(ThreadTeam& team, const VoxelOperator<double>& K, VoxelMultigrid& multigrid,
                                 const std::vector<std::size_t>& fixed_numbers, const VoxelField<double>& b,
                                 double tolerance, int max_iterations, VoxelField<double>& x) {
  VoxelField<double> r(b.nodes()), p(b.nodes()), q(b.nodes());
  const auto clear_fixed = [&fixed_numbers](VoxelField<double>& field) {
    for (const std::size_t k : fixed_numbers) field.data()[k] = 0;
  };
  K.Apply(x, team, q);
  ForNumbers(team, r.size(), [&](std::size_t k) { r.data()[k] = b.data()[k] - q.data()[k]; });
  clear_fixed(r);
  const double start = std::sqrt(Dot(team, r, r));
  VoxelCgResult result;
  double size = start, rz = 0;
  for (; size > tolerance * start && result.iterations < max_iterations; ++result.iterations) {
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
    K.Apply(p, team, q);
    clear_fixed(q);
    const double alpha = rz / Dot(team, p, q);
    if (!std::isfinite(alpha)) break;
    ForNumbers(team, x.size(), [&](std::size_t k) {
      x.data()[k] += alpha * p.data()[k];
      r.data()[k] -= alpha * q.data()[k];
    });
    size = std::sqrt(Dot(team, r, r));
  }
  result.converged = size <= tolerance * start;  // false for NaN
  result.residual = start > 0 ? size / start : 0;
  return result;
}

}  // namespace fascicle

#endif  // FASCICLE_CORE_VOXEL_CONJUGATE_GRADIENT_H_
