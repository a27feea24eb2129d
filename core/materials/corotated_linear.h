#ifndef FASCICLE_CORE_MATERIALS_COROTATED_LINEAR_H_
#define FASCICLE_CORE_MATERIALS_COROTATED_LINEAR_H_

#include <span>

#include "core/materials/isotropic_moduli.h"
#include "core/materials/rotation.h"
#include "core/materials/tangent_terms.h"

namespace fascicle {

// W = mu |F - R|^2 + lambda/2 tr(R^T F - I)^2 with R the rotation nearest to F. Finite for every finite F. Where two
// singular values (the least one with the sign of J) add to zero, R is not unique and the tangent is not finite.
class CorotatedLinear : public LawFunctions<CorotatedLinear> {
 public:
  static constexpr const char* kName = "corotated_linear";
  static constexpr const char* kTitle = "Corotated linear";
  static constexpr const char* kSource = "Sifakis 2012, FEM Simulation of 3D Deformable Solids, 3.4";
  static constexpr auto kParameters = IsotropicModuli::kParameters;
  static constexpr bool kNeedsFibres = false;
  static constexpr bool kStiffens = false;

  explicit CorotatedLinear(std::span<const double> values) : moduli_(values) {}

  template <class T>
  T EnergyAt(const Matrix3<T>& F, const Fibre<T>&) const {
    const Matrix3<T> R = NearestRotation(F);
    const T trace = Contract(R, F) - 3;
    return moduli_.mu * SquaredNorm(F - R) + 0.5 * moduli_.lambda * trace * trace;
  }

  template <class T>
  Matrix3<T> StressAt(const Matrix3<T>& F, const Fibre<T>&) const {
    const Matrix3<T> R = NearestRotation(F);
    return 2 * moduli_.mu * (F - R) + (moduli_.lambda * (Contract(R, F) - 3)) * R;
  }

  // dP = 2 mu (dF - dR) + lambda (R:dF) R + lambda tr(S - I) dR; with S = R^T F, E_k the cross product with axis k:
  // dR = sum_kl (R E_k) [(tr(S) I - S)^-1]_kl (R E_l : dF), from the skew part of R^T dF = R^T dR S + dS.
  template <class T, class Terms>
  void AddTangentAt(const Matrix3<T>& F, const Fibre<T>&, Terms& terms) const {
    const Matrix3<T> R = NearestRotation(F);
    const Matrix3<T> S = SymmetricPart(Transpose(R) * F);
    const T trace = Trace(S);
    const Matrix3<T> spin = PlusDiagonal(T(-1.0) * S, trace);
    const Matrix3<T> cofactor = Cofactor(spin);
    const T scale = (moduli_.lambda * (trace - 3) - 2 * moduli_.mu) / DeterminantOf(spin, cofactor);
    terms.Diagonal(2 * moduli_.mu);
    terms.Square(moduli_.lambda, R);
    const Matrix3<T> turned[3] = {Turned(R, 0), Turned(R, 1), Turned(R, 2)};
    for (int k = 0; k < 3; ++k) {
      terms.Square(scale * cofactor(k, k), turned[k]);
      const int l = (k + 1) % 3;
      terms.Pair((scale * cofactor(k, l)) * turned[k], turned[l]);
    }
  }

  double ShearModulus() const { return moduli_.mu; }
  double BulkModulus() const { return moduli_.Bulk(); }
  double VolumeModulus() const { return 0; }
  CorotatedLinear WithVolumeModulus(double) const { return *this; }

 private:
  // R E_k, with E_k x = e_k cross x.
  template <class T>
  static Matrix3<T> Turned(const Matrix3<T>& R, int k) {
    const int l = (k + 1) % 3, m = (k + 2) % 3;
    Matrix3<T> turned;
    for (int i = 0; i < 3; ++i) {
      turned(i, k) = T(0.0);
      turned(i, l) = R(i, m);
      turned(i, m) = -R(i, l);
    }
    return turned;
  }

  IsotropicModuli moduli_;
};
static_assert(ConstitutiveModel<CorotatedLinear>);

}  // namespace fascicle

#endif  // FASCICLE_CORE_MATERIALS_COROTATED_LINEAR_H_
