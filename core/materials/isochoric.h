#ifndef FASCICLE_CORE_MATERIALS_ISOCHORIC_H_
#define FASCICLE_CORE_MATERIALS_ISOCHORIC_H_

#include <cmath>

#include "core/materials/constitutive_model.h"
#include "core/materials/tensor_algebra.h"

// The nearly incompressible energy that Mooney-Rivlin, muscle and tendon share:
//
//   W = c1 (I1bar - 3) + c2 (I2bar - 3) + K/2 (ln J)^2 + F2(lambda),  lambda^2 = I4bar = J^(-2/3) |F a0|^2
//
// I1bar = J^(-2/3) I1, I2bar = J^(-4/3) I2, I1 = tr C, I2 = ((tr C)^2 - tr C^2)/2, C = F^T F. Small-strain moduli
// 2 (c1 + c2) and K. [Weiss 1996, Finite element implementation of incompressible, transversely isotropic
// hyperelasticity, Comput. Methods Appl. Mech. Eng. 135; Teran 2003, 5]
//
// The terms in I1bar and I4bar are linear in C: but for the curvature of F2, their derivatives are those of
// J^(-2/3) (C : N) with N = c1 I + W4 a0 a0^T and W4 = dF2/d(lambda^2). So the three laws share all but N.
namespace fascicle {

// Coefficients of the matrix that surrounds the fibres.
struct MatrixModuli {
  double c1;    // [Pa]
  double c2;    // [Pa]
  double bulk;  // K [Pa]
};

// What the terms need of one F. Where J <= 0 `log_J` and all that follows from it are not finite.
struct IsochoricKinematics {
  explicit IsochoricKinematics(const Mat3& F)
      : C(F.transpose() * F), I1(C.trace()), I2(0.5 * (I1 * I1 - C.squaredNorm())) {
    const Mat3 cofactor = Cofactor(F);
    const double J = DeterminantOf(F, cofactor);
    inverse_transpose = (1 / J) * cofactor;
    log_J = std::log(J);
    scale = std::exp(-2.0 / 3.0 * log_J);
  }

  // Isochoric fibre stretch.
  double FibreStretch(const Vec3& a0) const { return std::sqrt(scale * a0.dot(C * a0)); }

  Mat3 C;
  double I1, I2;
  Mat3 inverse_transpose;  // F^-T
  double log_J;            // ln J
  double scale;            // J^(-2/3)
};

// The energy without the fibres' [J/m^3].
inline double MatrixEnergy(const MatrixModuli& m, const IsochoricKinematics& k) {
  return m.c1 * (k.scale * k.I1 - 3) + m.c2 * (k.scale * k.scale * k.I2 - 3) + 0.5 * m.bulk * k.log_J * k.log_J;
}

// P = 2 J^(-2/3) F N + 2 c2 J^(-4/3) F (I1 I - C) + [K ln J - 2/3 J^(-2/3) C:N - 4/3 c2 J^(-4/3) I2] F^-T.
inline Mat3 NearlyIncompressibleStress(const Mat3& F, const IsochoricKinematics& k, const Mat3& N, double c2,
                                       double bulk) {
  const double s1 = 2 * k.scale;
  const double s2 = 2 * c2 * k.scale * k.scale;
  Mat3 S = s1 * N - s2 * k.C;
  S.diagonal().array() += s2 * k.I1;
  const double pressure = bulk * k.log_J - (s1 * Contract(k.C, N) + 2 * s2 * k.I2) / 3;
  return F * S + pressure * k.inverse_transpose;
}

// d/dF of the stress above with N held fixed; symmetric.
inline Mat9 NearlyIncompressibleTangent(const Mat3& F, const IsochoricKinematics& k, const Mat3& N, double c2,
                                        double bulk) {
  const double s1 = 2 * k.scale;
  const double s2 = 2 * c2 * k.scale * k.scale;
  const double contraction = Contract(k.C, N);
  const double pressure = bulk * k.log_J - (s1 * contraction + 2 * s2 * k.I2) / 3;
  const Vec9 f = Flatten(F);
  const Vec9 h = Flatten(k.inverse_transpose);

  // Both isochoric terms are a power of J times a function g of C; the cross terms are dg x dJ + dJ x dg.
  Mat3 S = s2 * (k.I1 * Mat3::Identity() - k.C);
  const Vec9 cross = (-2.0 / 3.0) * Flatten(F * (s1 * N + 2 * S));
  const double volumetric = bulk + (2.0 / 9.0) * s1 * contraction + (8.0 / 9.0) * s2 * k.I2;
  S += s1 * N;

  Mat9 tangent = (2 * s2) * f * f.transpose();
  tangent += cross * h.transpose();
  tangent += h * (cross + volumetric * h).transpose();
  AddRightProduct(1, S, tangent);
  AddTransposedProduct(-s2, F, tangent);
  AddLeftProduct(-s2, F * F.transpose(), tangent);
  AddTransposedProduct(-pressure, k.inverse_transpose, tangent);
  return tangent;
}

// d(lambda^2)/dF = 2 J^(-2/3) (F a0 a0^T - |F a0|^2/3 F^-T), flattened.
inline Vec9 FibreStretchSquaredGradient(const Mat3& F, const IsochoricKinematics& k, const Vec3& a0) {
  const Vec3 a = F * a0;
  return Flatten(2 * k.scale * (a * a0.transpose() - (a.squaredNorm() / 3) * k.inverse_transpose));
}

// Derivatives of the fibre energy F2 by lambda^2.
struct FibreDerivatives {
  // `slope` = F2'(lambda) and `curvature` = F2''(lambda) at `stretch` = lambda.
  FibreDerivatives(double stretch, double slope, double curvature)
      : W4(slope / (2 * stretch)), W44((0.5 * curvature - W4) / (2 * stretch * stretch)) {}

  double W4;   // F2' / (2 lambda) [Pa]
  double W44;  // (lambda F2'' - F2') / (4 lambda^3) [Pa]
};

// N = c1 I + W4 a0 a0^T.
inline Mat3 FibreWeight(double c1, double W4, const Vec3& a0) {
  Mat3 N = W4 * a0 * a0.transpose();
  N.diagonal().array() += c1;
  return N;
}

// The tangent with fibres: N held fixed, and the curvature of F2.
inline Mat9 FibreTangent(const Mat3& F, const IsochoricKinematics& k, const MatrixModuli& m, const Vec3& a0,
                         const FibreDerivatives& d) {
  Mat9 tangent = NearlyIncompressibleTangent(F, k, FibreWeight(m.c1, d.W4, a0), m.c2, m.bulk);
  const Vec9 gradient = FibreStretchSquaredGradient(F, k, a0);
  tangent += (d.W44 * gradient) * gradient.transpose();
  return tangent;
}

}  // namespace fascicle

#endif  // FASCICLE_CORE_MATERIALS_ISOCHORIC_H_
