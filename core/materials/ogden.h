#ifndef FASCICLE_CORE_MATERIALS_OGDEN_H_
#define FASCICLE_CORE_MATERIALS_OGDEN_H_

#include <array>
#include <span>

#include "core/materials/isochoric.h"
#include "core/materials/symmetric_eigen.h"

namespace fascicle {

// W = sum over i of c_i/m_i^2 (l1^m_i + l2^m_i + l3^m_i - 3) + K/2 (ln J)^2, l1 l2 l3 = 1 the isochoric principal
// stretches. Up to three terms; one with c_i = 0 is absent. Not finite where J <= 0.
//
// The convention is FEBio's. From Ogden's own, W = sum mu_i/alpha_i (...): m_i = alpha_i, c_i = mu_i alpha_i. From
// Abaqus', W = sum 2 mu_i/alpha_i^2 (...): m_i = alpha_i, c_i = 2 mu_i. The shear modulus at rest is half of the sum of
// the c_i. c_i >= 0 is Ogden's condition mu_i alpha_i >= 0, under which each term is convex in the logarithms of the
// stretches. m_i = 2 is the neo-Hookean term c/4 (I1bar - 3), m_i = -2 the Mooney-Rivlin term c/4 (I2bar - 3). A term
// with m_i = 0 is the limit c/2 sum (ln l_a)^2, Hencky's law.
class Ogden : public LawFunctions<Ogden> {
 public:
  static constexpr const char* kName = "ogden";
  static constexpr const char* kTitle = "Ogden (nearly incompressible, up to three terms)";
  static constexpr const char* kSource = "Ogden 1972, Large deformation isotropic elasticity; coefficients as in FEBio";
  static constexpr std::array<ParameterInfo, 7> kParameters = {{
      {"c1", "Pa", 0, true, 1e12, false, kRequired, "coefficient of the first term: Ogden's mu_1 alpha_1"},
      {"m1", "1", -1000, false, 1000, false, kRequired, "exponent of the first term"},
      {"c2", "Pa", 0, false, 1e12, false, 0, "coefficient of the second term; 0: absent"},
      {"m2", "1", -1000, false, 1000, false, 2, "exponent of the second term"},
      {"c3", "Pa", 0, false, 1e12, false, 0, "coefficient of the third term; 0: absent"},
      {"m3", "1", -1000, false, 1000, false, 2, "exponent of the third term"},
      {"bulk_modulus", "Pa", 0, true, 1e12, false, kRequired, "bulk modulus K"},
  }};
  static constexpr bool kNeedsFibres = false;
  static constexpr bool kStiffens = true;

  explicit Ogden(std::span<const double> values)
      : terms_{{{values[0], values[1]}, {values[2], values[3]}, {values[4], values[5]}}}, bulk_(values[6]) {}

  // With e_a = ln l_a, the sum of which is zero: l^m - 1 may be replaced by l^m - 1 - m e, which is small near rest.
  template <class T>
  T EnergyAt(const Matrix3<T>& F, const Fibre<T>&) const {
    const Principal<T> p(F);
    T energy = 0.5 * bulk_ * p.k.log_J * p.k.log_J;
    for (const Term& term : terms_) {
      if (term.c == 0) continue;
      for (int a = 0; a < 3; ++a) {
        energy += term.c * p.e[a] * p.e[a] * SecondExponentialQuotient<T>(term.m * p.e[a]);
      }
    }
    return energy;
  }

  template <class T>
  Matrix3<T> StressAt(const Matrix3<T>& F, const Fibre<T>&) const {
    const Principal<T> p(F);
    return F * SecondPiolaKirchhoff(p, Deviatoric(Slopes(p))) + (bulk_ * p.k.log_J * p.k.inverse_J) * p.k.cofactor;
  }

  // With the eigenvalues C_a = l_a^2 and eigenvectors N_a of C, the isochoric stress is S = sum S_a N_a N_a^T, S_a =
  // b_a/C_a, b_a the deviator of w_a = dW/de_a. dS has the entries dS_a/dC_b dC_b on the diagonal, and (S_a - S_b)/(C_a
  // - C_b) dC_ab beside it. With h_a = dw_a/de_a and Q_a = F N_a N_a^T/C_a, the sum of which is F^-T = H,
  //
  //   dP = sum (h_a - 2 b_a) (Q_a:dF) Q_a - 1/3 (G:dF) H - 1/3 (H:dF) G + 1/9 (sum h_a) (H:dF) H + ..., G = sum h_a Q_a
  template <class T, class Terms>
  void AddTangentAt(const Matrix3<T>& F, const Fibre<T>&, Terms& terms) const {
    const Principal<T> p(F);
    const Matrix3<T> H = p.k.InverseTranspose();
    const Vector3<T> b = Deviatoric(Slopes(p)), h = Curvatures(p);
    Matrix3<T> G = Diagonal(T(0.0));
    for (int a = 0; a < 3; ++a) {
      const Vector3<T> N = p.eigen.Vector(a);
      const Matrix3<T> Q = (1 / p.eigen.values[a]) * Outer(F * N, N);
      terms.Square(h[a] - 2 * b[a], Q);
      G = G + h[a] * Q;
    }
    terms.Pair((-1.0 / 3.0) * G + (0.5 * bulk_ + 1.0 / 18.0 * (h[0] + h[1] + h[2])) * H, H);
    for (int a = 0; a < 3; ++a) AddShear(F, p, b, a, (a + 1) % 3, terms);
    terms.Right(SecondPiolaKirchhoff(p, b));
    terms.Transposed(T(-bulk_ * p.k.log_J), H);
  }

  double ShearModulus() const { return 0.5 * (terms_[0].c + terms_[1].c + terms_[2].c); }
  double BulkModulus() const { return bulk_; }
  double VolumeModulus() const { return bulk_; }
  Ogden WithVolumeModulus(double k) const {
    Ogden law = *this;
    law.bulk_ = k;
    return law;
  }

 private:
  struct Term {
    double c;  // [Pa]
    double m;
  };

  template <class T>
  struct Principal {
    explicit Principal(const Matrix3<T>& F) : k(F), eigen(k.C) {
      for (int a = 0; a < 3; ++a) e[a] = 0.5 * Log(eigen.values[a]) - (1.0 / 3.0) * k.log_J;
    }
    IsochoricKinematics<T> k;
    SymmetricEigen<T> eigen;  // of C
    Vector3<T> e;             // logarithms of the isochoric principal stretches
  };

  // w_a = sum c_i/m_i (l_a^m_i - 1).
  template <class T>
  Vector3<T> Slopes(const Principal<T>& p) const {
    Vector3<T> w = {{T(0.0), T(0.0), T(0.0)}};
    for (const Term& term : terms_) {
      if (term.c == 0) continue;
      for (int a = 0; a < 3; ++a) w[a] += term.c * p.e[a] * ExponentialQuotient<T>(term.m * p.e[a]);
    }
    return w;
  }

  // h_a = sum c_i l_a^m_i.
  template <class T>
  Vector3<T> Curvatures(const Principal<T>& p) const {
    Vector3<T> h = {{T(0.0), T(0.0), T(0.0)}};
    for (const Term& term : terms_) {
      if (term.c == 0) continue;
      for (int a = 0; a < 3; ++a) h[a] += term.c * Exp(term.m * p.e[a]);
    }
    return h;
  }

  template <class T>
  static Vector3<T> Deviatoric(const Vector3<T>& w) {
    const T mean = (1.0 / 3.0) * (w[0] + w[1] + w[2]);
    return {{w[0] - mean, w[1] - mean, w[2] - mean}};
  }

  // S = sum b_a/C_a N_a N_a^T.
  template <class T>
  static Matrix3<T> SecondPiolaKirchhoff(const Principal<T>& p, const Vector3<T>& b) {
    Matrix3<T> S = Diagonal(T(0.0));
    for (int a = 0; a < 3; ++a) S = S + ScaledSquare(b[a] / p.eigen.values[a], p.eigen.Vector(a));
    return S;
  }

  // The entries (a, b) and (b, a) of dS. (S_a - S_b)/(C_a - C_b) is the mean of 1/C_a and 1/C_b times (w_a - w_b)/(C_a
  // - C_b), less (b_a + b_b)/(2 C_a C_b). Both differences are written by the divided difference of the exponential,
  // with d = e_a - e_b: w_a - w_b = d sum c_i l_b^m_i q(m_i d), C_a - C_b = 2 d C_b q(2 d), so that d cancels.
  template <class T, class Terms>
  void AddShear(const Matrix3<T>& F, const Principal<T>& p, const Vector3<T>& deviator, int a, int b,
                Terms& terms) const {
    const T d = p.e[a] - p.e[b];
    T difference = T(0.0);
    for (const Term& term : terms_) {
      if (term.c == 0) continue;
      difference += term.c * Exp(term.m * p.e[b]) * ExponentialQuotient<T>(term.m * d);
    }
    const T inverse_a = 1 / p.eigen.values[a], inverse_b = 1 / p.eigen.values[b];
    const T quotient = difference * inverse_b / (2 * ExponentialQuotient<T>(2 * d));
    const T weight = 0.5 * (quotient * (inverse_a + inverse_b) - (deviator[a] + deviator[b]) * inverse_a * inverse_b);
    const Vector3<T> N_a = p.eigen.Vector(a), N_b = p.eigen.Vector(b);
    terms.Square(weight, Outer(F * N_a, N_b) + Outer(F * N_b, N_a));
  }

  std::array<Term, 3> terms_;
  double bulk_;  // [Pa]
};
static_assert(ConstitutiveModel<Ogden>);

}  // namespace fascicle

#endif  // FASCICLE_CORE_MATERIALS_OGDEN_H_
