#ifndef FASCICLE_CORE_MATERIALS_SHEAR_INVARIANTS_H_
#define FASCICLE_CORE_MATERIALS_SHEAR_INVARIANTS_H_

#include "core/base/numbers.h"
#include "core/materials/constitutive_model.h"
#include "core/materials/tangent_terms.h"

// The matrix of Blemker's muscle and tendon, in strain invariants that each measure one mode:
//
//   W = G1 B1^2 + G2 B2^2 + K/2 (ln J)^2 + F2(lambda)
//   B1 = sqrt(I5/I4^2 - 1)                        shear along the fibres
//   B2 = arcosh((I1 I4 - I5)/(2 J sqrt(I4)))      shear across them, at constant area
//   lambda = J^(-1/3) sqrt(I4)                    isochoric stretch of the fibres
//
// I1 = tr C, I4 = a0.C a0, I5 = a0.C^2 a0 with the unit fibre direction a0. [Blemker, Pinsky, Delp 2005; Criscione,
// Douglas & Hunter 2001, J. Mech. Phys. Solids 49] Small-strain moduli 2 G1, 2 G2 and K. Without fibre stress, a change
// of the fibres' length at constant volume and shape across needs no energy.
//
// If the direction has another length, lambda is multiplied by it (a prestretch), but not the invariants of the matrix.
namespace fascicle {

struct ShearModuli {
  double along, across;  // G1, G2 [Pa]
  double bulk;           // K [Pa]
};

// arcosh(x)^2 and its derivatives for x >= 1, where x = 1 is regular.
template <class T>
struct SquaredArcosh {
  explicit SquaredArcosh(const T& x) {
    const T y = x - 1;
    // 2 sum (-1)^(n-1) (2y)^n / (n^2 binomial(2n, n))
    constexpr double kTerms[] = {
        2.0,          -1.0 / 3,    4.0 / 45,       -1.0 / 35,        16.0 / 1575,      -8.0 / 2079,
        32.0 / 21021, -4.0 / 6435, 256.0 / 984555, -128.0 / 1154725, 512.0 / 10669659, -128.0 / 6084351};
    T v = 0.0, d = 0.0, s = 0.0;
    for (int n = 11; n >= 0; --n) {
      s = s * y + d * 2;
      d = d * y + v;
      v = v * y + kTerms[n];
    }
    s = s * y + d * 2;
    d = d * y + v;
    v = v * y;
    const T square = y * (x + 1);  // x^2 - 1
    const T root = Sqrt(square), arcosh = Log(x + root);
    const T far = 2 * arcosh / root;
    const auto is_near = y < 0.1;
    value = Select(is_near, v, arcosh * arcosh);
    first = Select(is_near, d, far);
    second = Select(is_near, s, (2 - x * far) / square);
  }
  T value, first, second;
};

// Invariants of one F, and the energy, stress and tangent that follow from them. Where J <= 0, not finite.
template <class T>
class ShearKinematics {
 public:
  ShearKinematics(const Matrix3<T>& F, const Vector3<T>& direction)
      : F_(F),
        prestretch_(Sqrt(Dot(direction, direction))),
        a0_(Scaled(1 / prestretch_, direction)),
        a_(F * a0_),
        b_(Transpose(F) * a_),
        I1_(Contract(F, F)),
        I4_(Dot(a_, a_)),
        I5_(Dot(b_, b_)),
        cofactor_(Cofactor(F)),
        J_(DeterminantOf(F, cofactor_)),
        log_J_(Log(J_)),
        root_(Sqrt(I4_)),
        stretch_(root_ * InverseCubeRoot(J_)),
        x_((I1_ * I4_ - I5_) / (2 * J_ * root_)),
        across_(x_) {}

  // lambda times the prestretch.
  T FibreStretch() const { return prestretch_ * stretch_; }

  T MatrixEnergy(const ShearModuli& m) const {
    return m.along * (I5_ / (I4_ * I4_) - 1) + m.across * across_.value + 0.5 * m.bulk * log_J_ * log_J_;
  }

  // slope: F2' by FibreStretch().
  Matrix3<T> Stress(const ShearModuli& m, const T& slope) const {
    const Derivatives d = DerivativesOf(m, slope, T(0.0));
    return d.first[0] * Gradient(0) + d.first[1] * Gradient(1) + d.first[2] * Gradient(2) + d.first[3] * cofactor_;
  }

  template <class Terms>
  void AddTangent(const ShearModuli& m, const T& slope, const T& curvature, Terms& terms) const {
    const Derivatives d = DerivativesOf(m, slope, curvature);
    // Second derivatives of the invariants.
    terms.Diagonal(2 * d.first[0]);
    terms.Right((2 * d.first[1]) * Outer(a0_, a0_) + (2 * d.first[2]) * (Outer(b_, a0_) + Outer(a0_, b_)));
    terms.Left((2 * d.first[2]) * Outer(a_, a_));
    for (int j = 0; j < 3; ++j) {
      terms.Square(2 * d.first[2], Outer(Vector3<T>{{F_(0, j), F_(1, j), F_(2, j)}}, a0_));
    }
    terms.Transposed(d.first[2], Outer(a_, a0_) + F_);
    terms.Transposed(-d.first[2], Outer(a_, a0_) - F_);
    terms.CofactorTerm(d.first[3], F_);
    // Products of their gradients.
    for (int i = 0; i < 4; ++i) {
      Matrix3<T> sum = (0.5 * d.second[i][i]) * Gradient(i);
      for (int j = i + 1; j < 4; ++j) sum = sum + d.second[i][j] * Gradient(j);
      terms.Pair(Gradient(i), sum);
    }
  }

 private:
  // Derivatives of the energy by I1, I4, I5 and J; the second ones for i <= j.
  struct Derivatives {
    T first[4], second[4][4];
  };

  static Vector3<T> Scaled(const T& s, const Vector3<T>& v) { return {{s * v[0], s * v[1], s * v[2]}}; }

  // By F.
  Matrix3<T> Gradient(int invariant) const {
    switch (invariant) {
      case 0:
        return 2 * F_;
      case 1:
        return 2 * Outer(a_, a0_);
      case 2:
        return 2 * (Outer(a_, b_) + Outer(F_ * b_, a0_));
      case 3:
        return cofactor_;
    }
    return cofactor_;
  }

  Derivatives DerivativesOf(const ShearModuli& m, const T& slope, const T& curvature) const {
    const T inverse_I4 = 1 / I4_, inverse_J = 1 / J_, half = 0.5 * inverse_J / root_;
    // x by each invariant.
    const T x[4] = {half * I4_, half * I1_ - 0.5 * x_ * inverse_I4, -half, -x_ * inverse_J};
    T xx[4][4];
    for (auto& row : xx) {
      for (T& entry : row) entry = 0.0;
    }
    xx[0][1] = 0.5 * half;
    xx[1][1] = -0.5 * inverse_I4 * (half * I1_ + x[1] - x_ * inverse_I4);
    xx[1][2] = 0.5 * half * inverse_I4;
    for (int i = 0; i < 3; ++i) xx[i][3] = -x[i] * inverse_J;
    xx[3][3] = 2 * x_ * inverse_J * inverse_J;
    // lambda by I4 and J.
    const T l4 = 0.5 * stretch_ * inverse_I4, lJ = (-1.0 / 3.0) * stretch_ * inverse_J;
    const T of_fibre = prestretch_ * slope, of_fibre_twice = prestretch_ * prestretch_ * curvature;

    Derivatives d;
    for (int i = 0; i < 4; ++i) {
      d.first[i] = m.across * across_.first * x[i];
      for (int j = i; j < 4; ++j) {
        d.second[i][j] = m.across * (across_.second * x[i] * x[j] + across_.first * xx[i][j]);
      }
    }
    const T q5 = inverse_I4 * inverse_I4;
    d.first[1] += of_fibre * l4 - 2 * m.along * I5_ * q5 * inverse_I4;
    d.first[2] += m.along * q5;
    d.first[3] += of_fibre * lJ + m.bulk * log_J_ * inverse_J;
    d.second[1][1] += of_fibre_twice * l4 * l4 - 0.5 * of_fibre * l4 * inverse_I4 + 6 * m.along * I5_ * q5 * q5;
    d.second[1][2] += -2 * m.along * q5 * inverse_I4;
    d.second[1][3] += of_fibre_twice * l4 * lJ + 0.5 * of_fibre * lJ * inverse_I4;
    d.second[3][3] += of_fibre_twice * lJ * lJ - (4.0 / 3.0) * of_fibre * lJ * inverse_J +
                      m.bulk * (1 - log_J_) * inverse_J * inverse_J;
    return d;
  }

  Matrix3<T> F_;
  T prestretch_;
  Vector3<T> a0_, a_, b_;  // a = F a0, b = C a0
  T I1_, I4_, I5_;
  Matrix3<T> cofactor_;
  T J_, log_J_, root_, stretch_;
  T x_;
  SquaredArcosh<T> across_;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_MATERIALS_SHEAR_INVARIANTS_H_
