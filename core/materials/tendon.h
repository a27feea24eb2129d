#ifndef FASCICLE_CORE_MATERIALS_TENDON_H_
#define FASCICLE_CORE_MATERIALS_TENDON_H_

#include <array>
#include <span>

#include "core/materials/fibre_curves.h"
#include "core/materials/isochoric.h"

namespace fascicle {

// Tendon and aponeurosis: the matrix of `Muscle` with a passive fibre curve of its own.
//
//   W = c1 (I1bar - 3) + c2 (I2bar - 3) + K/2 (ln J)^2 + F2(lambda)
//   lambda F2' = L1 (exp(L2 (lambda - 1)) - 1) for 1 < lambda < transition, then a straight line; 0 for lambda <= 1
//
// lambda is the isochoric fibre stretch. Not finite where J <= 0.
class Tendon : public LawFunctions<Tendon> {
 public:
  static constexpr const char* kName = "tendon";
  static constexpr const char* kTitle = "Tendon and aponeurosis";
  static constexpr const char* kSource = "Blemker, Pinsky, Delp 2005; Weiss 1996; Teran 2003, section 5";
  static constexpr std::array<ParameterInfo, 6> kParameters = {{
      {"c1", "Pa", 0, true, 1e9, false, 5e4, "matrix coefficient A"},
      {"c2", "Pa", 0, false, 1e9, false, 5e4, "matrix coefficient B"},
      {"bulk_modulus", "Pa", 0, true, 1e12, false, 5e8, "bulk modulus K"},
      {"fibre_scale", "Pa", 0, false, 1e10, false, 2.7e6, "scale L1 of the exponential fibre stress"},
      {"fibre_exponent", "1", 0, true, 1000, false, 46.4, "exponent L2 of the fibre stress"},
      {"transition_stretch", "1", 1, true, 2, false, 1.03, "fibre stretch from which the fibre stress is a line"},
  }};
  static constexpr bool kNeedsFibres = true;
  static constexpr bool kStiffens = true;

  explicit Tendon(std::span<const double> values)
      : moduli_{values[0], values[1], values[2]}, curve_(values[3], values[4], values[5]) {}

  template <class T>
  T EnergyAt(const Matrix3<T>& F, const Fibre<T>& fibre) const {
    const IsochoricKinematics<T> k(F);
    return MatrixEnergy(moduli_, k) + curve_.IntegralOverLength(k.FibreStretch(fibre.direction));
  }

  template <class T>
  Matrix3<T> StressAt(const Matrix3<T>& F, const Fibre<T>& fibre) const {
    const IsochoricKinematics<T> k(F);
    const T stretch = k.FibreStretch(fibre.direction);
    const T W4 = curve_.Value(stretch) / (2 * stretch * stretch);
    return NearlyIncompressibleStress(moduli_, F, k, W4, fibre.direction);
  }

  template <class T, class Terms>
  void AddTangentAt(const Matrix3<T>& F, const Fibre<T>& fibre, Terms& terms) const {
    const IsochoricKinematics<T> k(F);
    const T stretch = k.FibreStretch(fibre.direction);
    const T slope = curve_.Value(stretch) / stretch;
    const T curvature = (curve_.Derivative(stretch) - slope) / stretch;
    AddFibreTangent(F, k, moduli_, fibre.direction, FibreDerivatives<T>(stretch, slope, curvature), terms);
  }

  double ShearModulus() const { return 2 * (moduli_.c1 + moduli_.c2); }
  double BulkModulus() const { return moduli_.bulk; }
  double VolumeModulus() const { return moduli_.bulk; }
  Tendon WithVolumeModulus(double k) const {
    Tendon law = *this;
    law.moduli_.bulk = k;
    return law;
  }

  // Cauchy stress along the fibre at isochoric stretch lambda: lambda F2'(lambda) [Pa].
  double FibreStress(double stretch) const { return curve_.Value(stretch); }

 private:
  MatrixModuli moduli_;
  ExponentialToeCurve curve_;
};
static_assert(ConstitutiveModel<Tendon>);

}  // namespace fascicle

#endif  // FASCICLE_CORE_MATERIALS_TENDON_H_
