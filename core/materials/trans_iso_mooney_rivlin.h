#ifndef FASCICLE_CORE_MATERIALS_TRANS_ISO_MOONEY_RIVLIN_H_
#define FASCICLE_CORE_MATERIALS_TRANS_ISO_MOONEY_RIVLIN_H_

#include <array>
#include <span>

#include "core/materials/fibre_curves.h"
#include "core/materials/isochoric.h"

namespace fascicle {

// Transversely isotropic Mooney-Rivlin with an active stress that does not depend on length.
//
//   W = c1 (I1bar - 3) + c2 (I2bar - 3) + K/2 (ln J)^2 + F2(lambda) + T0 alpha (|F a0|^2 - 1)/2
//   lambda F2' = c3 (exp(c4 (lambda - 1)) - 1) for 1 < lambda < lam_max, c5 lambda + c6 beyond; 0 for lambda <= 1
//
// lambda is the isochoric fibre stretch. c6 follows from the continuity of the stress; its slope jumps at lam_max
// unless c5 is the slope of the exponential there. The active part is the second Piola-Kirchhoff stress T0 alpha a0
// a0^T, which refers to the total stretch, not to the isochoric one. Parameters are named as in FEBio, whose material
// of this name with its uniaxial active contraction this is. Not finite where J <= 0.
class TransIsoMooneyRivlin : public LawFunctions<TransIsoMooneyRivlin> {
 public:
  static constexpr const char* kName = "trans_iso_mooney_rivlin";
  static constexpr const char* kTitle = "Transversely isotropic Mooney-Rivlin";
  static constexpr const char* kSource = "Weiss, Maker, Govindjee 1996; FEBio's material of this name";
  static constexpr std::array<ParameterInfo, 8> kParameters = {{
      {"c1", "Pa", 0, true, 1e12, false, kRequired, "first Mooney-Rivlin coefficient"},
      {"c2", "Pa", 0, false, 1e12, false, 0, "second Mooney-Rivlin coefficient"},
      {"c3", "Pa", 0, true, 1e12, false, kRequired, "scale of the exponential fibre stress"},
      {"c4", "1", 0, true, 1000, false, kRequired, "exponent of the fibre stress"},
      {"c5", "Pa", 0, true, 1e12, false, kRequired, "slope of the fibre stress beyond lam_max"},
      {"lam_max", "1", 1, true, 10, false, kRequired, "fibre stretch from which the fibre stress is a line"},
      {"bulk_modulus", "Pa", 0, true, 1e12, false, kRequired, "bulk modulus K"},
      {"active_stress", "Pa", 0, false, 1e9, false, 0, "second Piola-Kirchhoff stress T0 at full activation"},
  }};
  static constexpr bool kNeedsFibres = true;
  static constexpr bool kStiffens = true;

  explicit TransIsoMooneyRivlin(std::span<const double> values)
      : moduli_{values[0], values[1], values[6]},
        curve_(values[2], values[3], values[5], values[4]),
        active_stress_(values[7]) {}

  template <class T>
  T EnergyAt(const Matrix3<T>& F, const Fibre<T>& fibre) const {
    const IsochoricKinematics<T> k(F);
    const Vector3<T> a = F * fibre.direction;
    const T active = 0.5 * active_stress_ * fibre.activation * (Dot(a, a) - 1);
    return MatrixEnergy(moduli_, k) + curve_.IntegralOverLength(k.FibreStretch(fibre.direction)) + active;
  }

  template <class T>
  Matrix3<T> StressAt(const Matrix3<T>& F, const Fibre<T>& fibre) const {
    const Vector3<T>& a0 = fibre.direction;
    const IsochoricKinematics<T> k(F);
    const T stretch = k.FibreStretch(a0);
    const T W4 = curve_.Value(stretch) / (2 * stretch * stretch);
    const Matrix3<T> passive = NearlyIncompressibleStress(moduli_, F, k, W4, a0);
    return passive + (active_stress_ * fibre.activation) * Outer(F * a0, a0);
  }

  template <class T, class Terms>
  void AddTangentAt(const Matrix3<T>& F, const Fibre<T>& fibre, Terms& terms) const {
    const Vector3<T>& a0 = fibre.direction;
    const IsochoricKinematics<T> k(F);
    const T stretch = k.FibreStretch(a0);
    const T slope = curve_.Value(stretch) / stretch;
    const T curvature = (curve_.Derivative(stretch) - slope) / stretch;
    AddFibreTangent(F, k, moduli_, a0, FibreDerivatives<T>(stretch, slope, curvature), terms);
    terms.Right(ScaledSquare(active_stress_ * fibre.activation, a0));
  }

  double ShearModulus() const { return 2 * (moduli_.c1 + moduli_.c2); }
  double BulkModulus() const { return moduli_.bulk; }
  double VolumeModulus() const { return moduli_.bulk; }
  TransIsoMooneyRivlin WithVolumeModulus(double k) const {
    TransIsoMooneyRivlin law = *this;
    law.moduli_.bulk = k;
    return law;
  }

 private:
  MatrixModuli moduli_;
  ExponentialToeCurve curve_;
  double active_stress_;  // T0 [Pa]
};
static_assert(ConstitutiveModel<TransIsoMooneyRivlin>);

}  // namespace fascicle

#endif  // FASCICLE_CORE_MATERIALS_TRANS_ISO_MOONEY_RIVLIN_H_
