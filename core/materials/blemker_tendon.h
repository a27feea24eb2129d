#ifndef FASCICLE_CORE_MATERIALS_BLEMKER_TENDON_H_
#define FASCICLE_CORE_MATERIALS_BLEMKER_TENDON_H_

#include <array>
#include <span>

#include "core/materials/fibre_curves.h"
#include "core/materials/shear_invariants.h"

namespace fascicle {

// Blemker's tendon and aponeurosis with its own matrix, whose energy depends on shear along and across the fibres:
//
//   W = G1 B1^2 + G2 B2^2 + K/2 (ln J)^2 + F2(lambda)
//
// F2 as in `Tendon`, invariants as in shear_invariants.h. Not finite where J <= 0.
class BlemkerTendon : public LawFunctions<BlemkerTendon> {
 public:
  static constexpr const char* kName = "blemker_tendon";
  static constexpr const char* kTitle = "Tendon and aponeurosis with shear along and across its fibres";
  static constexpr const char* kSource = "Blemker, Pinsky, Delp 2005; Criscione, Douglas, Hunter 2001";
  static constexpr std::array<ParameterInfo, 6> kParameters = {{
      {"along_modulus", "Pa", 0, true, 1e9, false, 5e4, "G1: half of the shear modulus along the fibres"},
      {"across_modulus", "Pa", 0, true, 1e9, false, 5e4, "G2: half of the shear modulus across the fibres"},
      {"bulk_modulus", "Pa", 0, true, 1e12, false, 5e8, "bulk modulus K"},
      {"fibre_scale", "Pa", 0, false, 1e10, false, 2.7e6, "scale L1 of the exponential fibre stress"},
      {"fibre_exponent", "1", 0, true, 1000, false, 46.4, "exponent L2 of the fibre stress"},
      {"transition_stretch", "1", 1, true, 2, false, 1.03, "fibre stretch from which the fibre stress is a line"},
  }};
  static constexpr bool kNeedsFibres = true;
  static constexpr bool kStiffens = true;

  explicit BlemkerTendon(std::span<const double> values)
      : moduli_{values[0], values[1], values[2]}, curve_(values[3], values[4], values[5]) {}

  template <class T>
  T EnergyAt(const Matrix3<T>& F, const Fibre<T>& fibre) const {
    const ShearKinematics<T> k(F, fibre.direction);
    return k.MatrixEnergy(moduli_) + curve_.IntegralOverLength(k.FibreStretch());
  }

  template <class T>
  Matrix3<T> StressAt(const Matrix3<T>& F, const Fibre<T>& fibre) const {
    const ShearKinematics<T> k(F, fibre.direction);
    const T stretch = k.FibreStretch();
    return k.Stress(moduli_, curve_.Value(stretch) / stretch);
  }

  template <class T, class Terms>
  void AddTangentAt(const Matrix3<T>& F, const Fibre<T>& fibre, Terms& terms) const {
    const ShearKinematics<T> k(F, fibre.direction);
    const T stretch = k.FibreStretch();
    const T slope = curve_.Value(stretch) / stretch;
    k.AddTangent(moduli_, slope, (curve_.Derivative(stretch) - slope) / stretch, terms);
  }

  double ShearModulus() const { return 2 * (moduli_.along > moduli_.across ? moduli_.along : moduli_.across); }
  double ShearModulusAlong() const { return 2 * moduli_.along; }
  double ShearModulusAcross() const { return 2 * moduli_.across; }
  double BulkModulus() const { return moduli_.bulk; }
  double VolumeModulus() const { return moduli_.bulk; }
  BlemkerTendon WithVolumeModulus(double k) const {
    BlemkerTendon law = *this;
    law.moduli_.bulk = k;
    return law;
  }

  // Cauchy stress along the fibre at isochoric stretch lambda: lambda F2'(lambda) [Pa].
  double FibreStress(double stretch) const { return curve_.Value(stretch); }

 private:
  ShearModuli moduli_;
  ExponentialToeCurve curve_;
};
static_assert(ConstitutiveModel<BlemkerTendon>);

}  // namespace fascicle

#endif  // FASCICLE_CORE_MATERIALS_BLEMKER_TENDON_H_
