#ifndef FASCICLE_CORE_MATERIALS_FUNG_FIBRE_H_
#define FASCICLE_CORE_MATERIALS_FUNG_FIBRE_H_

#include <array>
#include <span>

#include "core/materials/fibre_curves.h"
#include "core/materials/isochoric.h"

namespace fascicle {

// Mooney-Rivlin with one family of passive, exponentially stiffening fibres:
//
//   W = c1 (I1bar - 3) + c2 (I2bar - 3) + K/2 (ln J)^2 + k1/(2 k2) (exp(k2 (I4bar - 1)^2) - 1) for I4bar > 1
//
// I4bar is the square of the isochoric fibre stretch. Fibres that are shortened bear no stress. Not finite where J <=
// 0.
class FungFibre : public LawFunctions<FungFibre> {
 public:
  static constexpr const char* kName = "fung_fibre";
  static constexpr const char* kTitle = "Mooney-Rivlin with Fung-type fibres";
  static constexpr const char* kSource = "Fung 1967; Holzapfel, Gasser, Ogden 2000, equation 65 with one family";
  static constexpr std::array<ParameterInfo, 5> kParameters = {{
      {"c1", "Pa", 0, true, 1e12, false, kRequired, "first Mooney-Rivlin coefficient"},
      {"c2", "Pa", 0, false, 1e12, false, 0, "second Mooney-Rivlin coefficient"},
      {"k1", "Pa", 0, false, 1e12, false, kRequired, "stiffness of the fibres at small stretch"},
      {"k2", "1", 0, false, 1e6, false, kRequired, "exponent of the fibres; 0: quadratic in I4bar - 1"},
      {"bulk_modulus", "Pa", 0, true, 1e12, false, kRequired, "bulk modulus K"},
  }};
  static constexpr bool kNeedsFibres = true;
  static constexpr bool kStiffens = true;

  explicit FungFibre(std::span<const double> values)
      : moduli_{values[0], values[1], values[4]}, curve_{values[2], values[3]} {}

  template <class T>
  T EnergyAt(const Matrix3<T>& F, const Fibre<T>& fibre) const {
    const IsochoricKinematics<T> k(F);
    return MatrixEnergy(moduli_, k) + curve_.Energy(Strain(k, fibre.direction));
  }

  template <class T>
  Matrix3<T> StressAt(const Matrix3<T>& F, const Fibre<T>& fibre) const {
    const IsochoricKinematics<T> k(F);
    const T W4 = curve_.Derivative(Strain(k, fibre.direction));
    return NearlyIncompressibleStress(moduli_, F, k, W4, fibre.direction);
  }

  template <class T, class Terms>
  void AddTangentAt(const Matrix3<T>& F, const Fibre<T>& fibre, Terms& terms) const {
    const Vector3<T>& a0 = fibre.direction;
    const IsochoricKinematics<T> k(F);
    const T E = Strain(k, a0);
    const Matrix3<T> N = FibreWeight(moduli_.c1, curve_.Derivative(E), a0);
    AddNearlyIncompressibleTangent(F, k, N, moduli_.c2, moduli_.bulk, terms);
    terms.Square(curve_.SecondDerivative(E), FibreStretchSquaredGradient(F, k, a0));
  }

  double ShearModulus() const { return 2 * (moduli_.c1 + moduli_.c2); }
  double BulkModulus() const { return moduli_.bulk; }
  double VolumeModulus() const { return moduli_.bulk; }
  FungFibre WithVolumeModulus(double k) const {
    FungFibre law = *this;
    law.moduli_.bulk = k;
    return law;
  }

 private:
  // I4bar - 1.
  template <class T>
  static T Strain(const IsochoricKinematics<T>& k, const Vector3<T>& a0) {
    return k.scale * Dot(a0, k.C * a0) - 1;
  }

  MatrixModuli moduli_;
  FungCurve curve_;
};
static_assert(ConstitutiveModel<FungFibre>);

}  // namespace fascicle

#endif  // FASCICLE_CORE_MATERIALS_FUNG_FIBRE_H_
