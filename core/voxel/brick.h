#ifndef FASCICLE_CORE_VOXEL_BRICK_H_
#define FASCICLE_CORE_VOXEL_BRICK_H_

#include <Eigen/Core>

#include "core/base/types.h"
#include "core/voxel/brick_modes.h"

// The element of the method: a brick with eight nodes, isotropic linear elasticity and 2x2x2 Gauss points. Corner c is
// at ((c & 1), (c >> 1 & 1), (c >> 2)) times the spacing; unknown 3 c + d is component d of its displacement.
namespace fascicle {

using BrickMatrix = Eigen::Matrix<double, 24, 24>;
using BrickVector = Eigen::Matrix<double, 24, 1>;

struct VoxelMaterial {
  double young_modulus = 0;  // > 0 [Pa]
  double poisson_ratio = 0;  // in (-1, 0.5) [1]
};

// Treatment of the dilatation.
enum class Dilatation {
  kFull,  // at each Gauss point; locks where K/mu is large
  kMean,  // averaged over the brick [Hughes 1980, Int. J. Numer. Meth. Engng 15, B-bar; Nagtegaal, Parks & Rice 1974]
};

BrickModuli<double> ModuliOf(const VoxelMaterial& material, Dilatation dilatation);

// Requires spacing > 0 [m].
template <class S>
BrickShape<S> ShapeOf(const Vec3& spacing);

// K of one brick [N/m]: symmetric, positive semidefinite, with six rigid body modes.
BrickMatrix BrickStiffness(const Vec3& spacing, const BrickModuli<double>& moduli);

// The diagonal of K; for each component the same at all corners [N/m].
Vec3 BrickDiagonal(const Vec3& spacing, const BrickModuli<double>& moduli);

// Gradients of the trilinear shape functions at xi in [-1, 1]^3: column c is that of corner c [1/m].
Eigen::Matrix<double, 3, 8> BrickGradients(const Vec3& spacing, const Vec3& xi);

}  // namespace fascicle

#endif  // FASCICLE_CORE_VOXEL_BRICK_H_
