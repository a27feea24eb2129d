#include "core/voxel/rotated_bricks.h"

#include <algorithm>
#include <cmath>

namespace fascicle {

template <class S>
BrickRotations<S>::BrickRotations(std::int32_t voxels)
    : voxels_(voxels), stride_(static_cast<std::size_t>(voxels) + VoxelField<S>::kPadding), values_(9 * stride_, S{0}) {
  for (int k = 0; k < 9; k += 4) std::fill(component(k), component(k) + stride_, S{1});
}
template class BrickRotations<double>;
template class BrickRotations<float>;

double LargestAngle(const BrickRotations<double>& a, const BrickRotations<double>& b) {
  double largest = 0;  // of |A - B|^2 = 8 sin(angle / 2)^2
  for (std::int32_t v = 0; v < a.voxels(); ++v) {
    double square = 0;
    for (int k = 0; k < 9; ++k) square += std::pow(a.component(k)[v] - b.component(k)[v], 2);
    largest = std::max(largest, square);
  }
  return 2 * std::asin(std::min(1.0, std::sqrt(largest / 8)));
}

RotatedBricks::RotatedBricks(const VoxelOperator<double>& K) : K_(&K), energy_(K.mesh().voxels()) {}

double RotatedBricks::Forces(const VoxelField<double>& u, ThreadTeam& team, BrickRotations<double>& R,
                             VoxelField<double>& f) {
  ForSlabs(K_->mesh(), team, [&](std::size_t s) {
    ClearSlab(K_->mesh(), s, f);
    RotatedTask<double> task = {};
    static_cast<ProductTask<double>&>(task) = K_->TaskOf(s, u, f);
    for (int k = 0; k < 9; ++k) task.new_rotation[k] = R.component(k);
    task.energy = energy_.data();
    K_->kernels().rotated_forces(task);
  });
  return SumOverNumbers(team, energy_.size(), [this](std::size_t v) { return energy_[v]; });
}

void RotatedBricks::ApplyTangent(const VoxelField<double>& u, const BrickRotations<double>& R,
                                 const VoxelField<double>& x, ThreadTeam& team, VoxelField<double>& y) const {
  ForSlabs(K_->mesh(), team, [&](std::size_t s) {
    ClearSlab(K_->mesh(), s, y);
    RotatedTask<double> task = {};
    static_cast<ProductTask<double>&>(task) = K_->TaskOf(s, x, y);
    for (int d = 0; d < 3; ++d) task.at[d] = u.component(d);
    for (int k = 0; k < 9; ++k) task.rotation[k] = R.component(k);
    K_->kernels().rotated_tangent(task);
  });
}

}  // namespace fascicle
