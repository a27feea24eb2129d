#ifndef FASCICLE_CORE_MATERIALS_ISOCHORIC_H_
#define FASCICLE_CORE_MATERIALS_ISOCHORIC_H_

#include "core/base/numbers.h"
#include "core/materials/constitutive_model.h"
#include "core/materials/tangent_terms.h"

// What the nearly incompressible laws share. Mooney-Rivlin, muscle, tendon and their relatives:
//
//   W = c1 (I1bar - 3) + c2 (I2bar - 3) + K/2 (ln J)^2 + F2(lambda),  lambda^2 = I4bar = J^(-2/3) |F a0|^2
//
// I1bar = J^(-2/3) I1, I2bar = J^(-4/3) I2, I1 = tr C, I2 = ((tr C)^2 - tr C^2)/2, C = F^T F. Small-strain moduli
// 2 (c1 + c2) and K. [Weiss 1996, Finite element implementation of incompressible, transversely isotropic
// hyperelasticity, Comput. Methods Appl. Mech. Eng. 135; Teran 2003, 5]
//
// The terms in I1bar and I4bar are linear in C. Apart from the curvature of F2, their derivatives are those of J^(-2/3)
// (C : N) with N = c1 I + W4 a0 a0^T and W4 = dF2/d(lambda^2). So they share everything but N.
namespace fascicle {

// Coefficients of the matrix that surrounds the fibres.
struct MatrixModuli {
  double c1;    // [Pa]
  double c2;    // [Pa]
  double bulk;  // K [Pa]
};

// Invariants of one F. Where J <= 0, `log_J` and everything derived from it are not finite.
template <class T>
struct IsochoricKinematics {
  explicit IsochoricKinematics(const Matrix3<T>& F) : C(Transpose(F) * F), I1(Trace(C)), cofactor(Cofactor(F)) {
    I2 = C(0, 0) * C(1, 1) + C(1, 1) * C(2, 2) + C(2, 2) * C(0, 0) -
         (C(0, 1) * C(0, 1) + C(1, 2) * C(1, 2) + C(2, 0) * C(2, 0));
    const T J = DeterminantOf(F, cofactor);
    inverse_J = 1 / J;
    log_J = Log(J);
    const T inverse_length = InverseCubeRoot(J);
    scale = inverse_length * inverse_length;
  }

  // F^-T.
  Matrix3<T> InverseTranspose() const { return inverse_J * cofactor; }
  // Isochoric fibre stretch.
  T FibreStretch(const Vector3<T>& a0) const { return Sqrt(scale * Dot(a0, C * a0)); }

  Matrix3<T> C;
  T I1, I2;
  Matrix3<T> cofactor;  // J F^-T
  T inverse_J;          // 1/J
  T log_J;              // ln J
  T scale;              // J^(-2/3)
};

// The energy without the fibre term [J/m^3].
template <class T>
T MatrixEnergy(const MatrixModuli& m, const IsochoricKinematics<T>& k) {
  return m.c1 * (k.scale * k.I1 - 3) + m.c2 * (k.scale * k.scale * k.I2 - 3) + 0.5 * m.bulk * k.log_J * k.log_J;
}

// P = 2 J^(-2/3) F N + 2 c2 J^(-4/3) F (I1 I - C) + [K ln J - 2/3 J^(-2/3) C:N - 4/3 c2 J^(-4/3) I2] F^-T with
// N = c1 I + W4 a0 a0^T.
template <class T>
Matrix3<T> NearlyIncompressibleStress(const MatrixModuli& m, const Matrix3<T>& F, const IsochoricKinematics<T>& k,
                                      const T& W4, const Vector3<T>& a0) {
  const T s1 = 2 * k.scale;
  const T s2 = 2 * m.c2 * k.scale * k.scale;
  const Matrix3<T> S = PlusDiagonal(ScaledSquare(s1 * W4, a0) - s2 * k.C, s1 * m.c1 + s2 * k.I1);
  const T contraction = m.c1 * k.I1 + W4 * Dot(a0, k.C * a0);  // C:N
  const T pressure = m.bulk * k.log_J - (1.0 / 3.0) * (s1 * contraction + 2 * s2 * k.I2);
  return F * S + (pressure * k.inverse_J) * k.cofactor;
}
// The stress without the fibre term.
template <class T>
Matrix3<T> NearlyIncompressibleStress(const MatrixModuli& m, const Matrix3<T>& F, const IsochoricKinematics<T>& k) {
  return NearlyIncompressibleStress(m, F, k, T(0.0), {T(0.0), T(0.0), T(0.0)});
}

// Adds the derivative by F of the stress above, with N held constant; symmetric.
template <class T, class Terms>
void AddNearlyIncompressibleTangent(const Matrix3<T>& F, const IsochoricKinematics<T>& k, const Matrix3<T>& N,
                                    double c2, double bulk, Terms& terms) {
  const T s1 = 2 * k.scale;
  const T s2 = 2 * c2 * k.scale * k.scale;
  const T contraction = Contract(k.C, N);
  const T pressure = bulk * k.log_J - (1.0 / 3.0) * (s1 * contraction + 2 * s2 * k.I2);
  const Matrix3<T> h = k.InverseTranspose();

  // Both isochoric terms are a power of J times a function g of C; the cross terms are dg x dJ + dJ x dg.
  const Matrix3<T> S2 = PlusDiagonal(-s2 * k.C, s2 * k.I1);
  const Matrix3<T> cross = (-2.0 / 3.0) * (F * (s1 * N + 2 * S2));
  const T volumetric = bulk + (2.0 / 9.0) * s1 * contraction + (8.0 / 9.0) * s2 * k.I2;

  terms.Square(2 * s2, F);
  terms.Pair(cross + (0.5 * volumetric) * h, h);
  terms.Right(S2 + s1 * N);
  terms.Transposed(-s2, F);
  terms.Left(-s2 * (F * Transpose(F)));
  terms.Transposed(-pressure, h);
}

// d(lambda^2)/dF = 2 J^(-2/3) (F a0 a0^T - |F a0|^2/3 F^-T).
template <class T>
Matrix3<T> FibreStretchSquaredGradient(const Matrix3<T>& F, const IsochoricKinematics<T>& k, const Vector3<T>& a0) {
  const Vector3<T> a = F * a0;
  return (2 * k.scale) * (Outer(a, a0) - (1.0 / 3.0 * Dot(a, a)) * k.InverseTranspose());
}

// The gradient of an invariant Cbar:N of a constant symmetric N:
// d(J^(-2/3) C:N)/dF = 2 J^(-2/3) (F N - C:N/3 F^-T).
template <class T>
Matrix3<T> InvariantGradient(const Matrix3<T>& F, const IsochoricKinematics<T>& k, const Matrix3<T>& N) {
  return (2 * k.scale) * (F * N - (1.0 / 3.0 * Contract(k.C, N)) * k.InverseTranspose());
}

// Laws whose energy is K/2 (ln J)^2 and a function of such invariants alone. N is the sum of their matrices, each times
// the derivative of the energy with respect to its invariant.
template <class T>
Matrix3<T> StressOfInvariants(const Matrix3<T>& F, const IsochoricKinematics<T>& k, const Matrix3<T>& N, double bulk) {
  return InvariantGradient(F, k, N) + (bulk * k.log_J * k.inverse_J) * k.cofactor;
}
// Adds the derivative by F of the stress above, with N held constant.
template <class T, class Terms>
void AddTangentOfInvariants(const Matrix3<T>& F, const IsochoricKinematics<T>& k, const Matrix3<T>& N, double bulk,
                            Terms& terms) {
  const T s = 2 * k.scale;
  const T contraction = s * Contract(k.C, N);
  const Matrix3<T> h = k.InverseTranspose();
  terms.Pair((-2.0 / 3.0 * s) * (F * N) + (0.5 * bulk + (1.0 / 9.0) * contraction) * h, h);
  terms.Right(s * N);
  terms.Transposed((1.0 / 3.0) * contraction - bulk * k.log_J, h);
}

// Derivatives of the fibre energy F2 with respect to lambda^2.
template <class T>
struct FibreDerivatives {
  // `slope` = F2'(lambda) and `curvature` = F2''(lambda) at `stretch` = lambda.
  FibreDerivatives(const T& stretch, const T& slope, const T& curvature)
      : W4(slope / (2 * stretch)), W44((0.5 * curvature - W4) / (2 * stretch * stretch)) {}

  T W4;   // F2' / (2 lambda) [Pa]
  T W44;  // (lambda F2'' - F2') / (4 lambda^3) [Pa]
};

// N = c1 I + W4 a0 a0^T.
template <class T>
Matrix3<T> FibreWeight(double c1, const T& W4, const Vector3<T>& a0) {
  return PlusDiagonal(ScaledSquare(W4, a0), c1);
}

// Adds the tangent with fibres: the derivative with N held constant, and the curvature of F2.
template <class T, class Terms>
void AddFibreTangent(const Matrix3<T>& F, const IsochoricKinematics<T>& k, const MatrixModuli& m, const Vector3<T>& a0,
                     const FibreDerivatives<T>& d, Terms& terms) {
  AddNearlyIncompressibleTangent(F, k, FibreWeight(m.c1, d.W4, a0), m.c2, m.bulk, terms);
  terms.Square(d.W44, FibreStretchSquaredGradient(F, k, a0));
}

}  // namespace fascicle

#endif  // FASCICLE_CORE_MATERIALS_ISOCHORIC_H_
