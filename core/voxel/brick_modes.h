#ifndef FASCICLE_CORE_VOXEL_BRICK_MODES_H_
#define FASCICLE_CORE_VOXEL_BRICK_MODES_H_

// The stiffness of an eight-node brick in terms of even and odd modes.
//
// Trilinear displacements of a brick are combinations of the eight products of 1, xi, eta, zeta (coordinates from -1 to
// 1). Sums and differences of the corner values (a Hadamard transform of length eight) are the coefficients times
// eight. The products are orthogonal over the brick, so that with isotropic stiffness most of them decouple: of 24 x 24
// entries 45 remain. Two Gauss points along each edge integrate all of them exactly:
//   mean of xi^2 = 1/3, of xi^2 eta^2 = 1/9.
namespace fascicle {

// The modes: m is a sum of bits, 1 for xi, 2 for eta, 4 for zeta.
enum BrickMode { kModeOne, kModeX, kModeY, kModeXY, kModeZ, kModeXZ, kModeYZ, kModeXYZ };

// The moduli of a material as used by a brick. T: a number, or several side by side.
template <class T>
struct BrickModuli {
  T lambda;      // for the mean dilatation [Pa]
  T lambda_out;  // for the deviation of the dilatation from its mean [Pa]: lambda, or -2 mu/3 with mean dilatation
  T mu;          // [Pa]
};

// Factors that depend on the spacing h [m]: for constant gradients a_d = sqrt(V)/(4 h_d), for gradients that vary in
// one direction b = a/sqrt(3) [m^(1/2)], in two directions q = a/3. Products are stored, so that kernels need not
// compute them for each voxel.
template <class S>
struct BrickShape {
  S a[3], b[3];
  S b_square[3];
  S along[3], across[3];  // q_d^2, and the sum of the other two [m]
};

// Modal forces f for modal displacements u: f[component][mode]. kModeOne (translation) is neither read nor written.
template <class T, class S>
[[gnu::always_inline]] inline void ModeForces(const BrickShape<S>& shape, const BrickModuli<T>& moduli,
                                              const T (&u)[3][8], T (&f)[3][8]) {
  const T mu = moduli.mu;
  const T two_mu = mu + mu;
  const T a[3] = {T(shape.a[0]), T(shape.a[1]), T(shape.a[2])};
  const T b[3] = {T(shape.b[0]), T(shape.b[1]), T(shape.b[2])};
  constexpr int kSingle[3] = {kModeX, kModeY, kModeZ};
  // The mode that varies along both axes of a pair.
  constexpr int kPair[3][3] = {{-1, kModeXY, kModeXZ}, {kModeXY, -1, kModeYZ}, {kModeXZ, kModeYZ, -1}};

  // Constant strain.
  const T e[3] = {a[0] * u[0][kModeX], a[1] * u[1][kModeY], a[2] * u[2][kModeZ]};
  const T pressure = moduli.lambda * (e[0] + e[1] + e[2]);
  for (int d = 0; d < 3; ++d) f[d][kSingle[d]] = a[d] * (two_mu * e[d] + pressure);
  for (int d = 0; d < 3; ++d) {
    const int g = (d + 1) % 3;
    const T shear = mu * (a[g] * u[d][kSingle[g]] + a[d] * u[g][kSingle[d]]);
    f[d][kSingle[g]] = a[g] * shear;
    f[g][kSingle[d]] = a[d] * shear;
  }
  // Dilatation that varies along axis d: components g and h, in the modes that also vary along d.
  for (int d = 0; d < 3; ++d) {
    const int g = (d + 1) % 3, h = (d + 2) % 3;
    const T ug = u[g][kPair[d][g]], uh = u[h][kPair[d][h]];
    const T eg = b[g] * ug, eh = b[h] * uh;
    const T varying = moduli.lambda_out * (eg + eh);
    const T shear = mu * T(shape.b_square[d]);  // du_g/dx_d, which varies along g alone
    f[g][kPair[d][g]] = b[g] * (two_mu * eg + varying) + shear * ug;
    f[h][kPair[d][h]] = b[h] * (two_mu * eh + varying) + shear * uh;
  }
  // Warping: component d in the mode of the other two axes. The shear of d and g varies along the third axis.
  T warp[3];
  for (int d = 0; d < 3; ++d) {
    const int g = (d + 1) % 3, h = (d + 2) % 3;
    warp[h] = mu * (b[g] * u[d][kPair[g][h]] + b[d] * u[g][kPair[d][h]]);
  }
  for (int d = 0; d < 3; ++d) {
    const int g = (d + 1) % 3, h = (d + 2) % 3;
    f[d][kPair[g][h]] = b[g] * warp[h] + b[h] * warp[g];
  }
  const T stiff = two_mu + moduli.lambda_out;
  for (int d = 0; d < 3; ++d) {
    f[d][kModeXYZ] = (stiff * T(shape.along[d]) + mu * T(shape.across[d])) * u[d][kModeXYZ];
  }
}

}  // namespace fascicle

#endif  // FASCICLE_CORE_VOXEL_BRICK_MODES_H_
