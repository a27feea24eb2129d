#ifndef FASCICLE_CORE_VOXEL_ROTATED_BRICKS_H_
#define FASCICLE_CORE_VOXEL_ROTATED_BRICKS_H_

#include <vector>

#include "core/voxel/voxel_operator.h"

namespace fascicle {

// A rotation for each voxel of a mesh, component by component; initially identities.
template <class S>
class BrickRotations {
 public:
  explicit BrickRotations(std::int32_t voxels);
  template <class T>
  explicit BrickRotations(const BrickRotations<T>& other) : BrickRotations(other.voxels()) {
    for (int k = 0; k < 9; ++k) {
      for (std::int32_t v = 0; v < voxels_; ++v) component(k)[v] = static_cast<S>(other.component(k)[v]);
    }
  }

  std::int32_t voxels() const { return voxels_; }
  // Entry (k % 3, k / 3) for all voxels, followed by kPadding more.
  S* component(int k) { return values_.data() + k * stride_; }
  const S* component(int k) const { return values_.data() + k * stride_; }
  Mat3 At(std::int32_t voxel) const {
    Mat3 R;
    for (int k = 0; k < 9; ++k) R(k % 3, k / 3) = static_cast<double>(component(k)[voxel]);
    return R;
  }

 private:
  std::int32_t voxels_;
  std::size_t stride_;
  std::vector<S> values_;
};

// The largest angle by which the rotation of any voxel differs [rad].
double LargestAngle(const BrickRotations<double>& a, const BrickRotations<double>& b);

// Corotated bricks, which are linear in frames that rotate with them: with the positions x of the corners, their rest
// positions X, and R the rotation nearest to the deformation gradient at the centre, the energy is
//   1/2 (R^T x - X) . K (R^T x - X).
// The forces R K (R^T x - X) + (terms from dR/dx) and their derivative are exact: rigid motions cause no force, forces
// have no torque, the derivative is symmetric. [Mueller & Gross 2004, Interactive virtual materials, whose forces are
// the first part only.] The same bits for any number of threads and every instruction set. Not thread-safe.
class RotatedBricks {
 public:
  // K of the unrotated bricks must outlive this object.
  explicit RotatedBricks(const VoxelOperator<double>& K);

  // Sets f to the forces at displacements u [N] and R to the rotations there; returns the energy [J].
  double Forces(const VoxelField<double>& u, ThreadTeam& team, BrickRotations<double>& R, VoxelField<double>& f);

  // y = (df/du) x at displacements u with rotations R.
  void ApplyTangent(const VoxelField<double>& u, const BrickRotations<double>& R, const VoxelField<double>& x,
                    ThreadTeam& team, VoxelField<double>& y) const;

 private:
  const VoxelOperator<double>* K_;
  std::vector<double> energy_;  // of each voxel [J]
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_VOXEL_ROTATED_BRICKS_H_
