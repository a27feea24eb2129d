#include "core/voxel/brick.h"

#include <array>
#include <bit>
#include <cmath>

#include "core/materials/isotropic_moduli.h"

namespace fascicle {
namespace {

// The sign, +1 or -1, of mode m at corner c.
double SignOf(int mode, int corner) { return std::popcount(static_cast<unsigned>(mode & ~corner)) % 2 == 0 ? 1 : -1; }

}  // namespace

BrickModuli<double> ModuliOf(const VoxelMaterial& material, Dilatation dilatation) {
  const IsotropicModuli moduli(std::array{material.young_modulus, material.poisson_ratio});
  return {moduli.lambda, dilatation == Dilatation::kFull ? moduli.lambda : -2 * moduli.mu / 3, moduli.mu};
}

template <class S>
BrickShape<S> ShapeOf(const Vec3& spacing) {
  BrickShape<S> shape;
  for (int d = 0; d < 3; ++d) {
    const double a = std::sqrt(spacing.prod()) / (4 * spacing[d]), q = a / 3;
    shape.a[d] = static_cast<S>(a);
    shape.b[d] = static_cast<S>(a / std::sqrt(3.0));
    shape.b_square[d] = static_cast<S>(a * a / 3);
    shape.along[d] = static_cast<S>(q * q);
  }
  for (int d = 0; d < 3; ++d) shape.across[d] = shape.along[(d + 1) % 3] + shape.along[(d + 2) % 3];
  return shape;
}
template BrickShape<double> ShapeOf(const Vec3&);
template BrickShape<float> ShapeOf(const Vec3&);

BrickMatrix BrickStiffness(const Vec3& spacing, const BrickModuli<double>& moduli) {
  const BrickShape<double> shape = ShapeOf<double>(spacing);
  BrickMatrix K;
  for (int column = 0; column < 24; ++column) {
    double u[3][8] = {}, f[3][8] = {};
    for (int m = 0; m < 8; ++m) u[column % 3][m] = SignOf(m, column / 3);
    ModeForces(shape, moduli, u, f);
    for (int row = 0; row < 24; ++row) {
      double sum = 0;
      for (int m = 1; m < 8; ++m) sum += SignOf(m, row / 3) * f[row % 3][m];
      K(row, column) = sum;
    }
  }
  return K;
}

Vec3 BrickDiagonal(const Vec3& spacing, const BrickModuli<double>& moduli) {
  return BrickStiffness(spacing, moduli).diagonal().head<3>();
}

Eigen::Matrix<double, 3, 8> BrickGradients(const Vec3& spacing, const Vec3& xi) {
  Eigen::Matrix<double, 3, 8> gradients;
  for (int c = 0; c < 8; ++c) {
    const Vec3 side((c & 1) ? 1 : -1, (c & 2) ? 1 : -1, (c & 4) ? 1 : -1);
    const Vec3 factor = 0.5 * (Vec3::Ones() + side.cwiseProduct(xi));
    for (int d = 0; d < 3; ++d) gradients(d, c) = side[d] / spacing[d] * factor[(d + 1) % 3] * factor[(d + 2) % 3];
  }
  return gradients;
}

}  // namespace fascicle
