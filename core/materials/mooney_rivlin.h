#ifndef FASCICLE_CORE_MATERIALS_MOONEY_RIVLIN_H_
#define FASCICLE_CORE_MATERIALS_MOONEY_RIVLIN_H_

#include <array>
#include <span>

#include "core/materials/isochoric.h"

namespace fascicle {

// W = c1 (I1bar - 3) + c2 (I2bar - 3) + K/2 (ln J)^2. Not finite where J <= 0.
class MooneyRivlin : public LawFunctions<MooneyRivlin> {
 public:
  static constexpr const char* kName = "mooney_rivlin";
  static constexpr const char* kTitle = "Mooney-Rivlin (nearly incompressible)";
  static constexpr const char* kSource = "Mooney 1940; Rivlin 1948; split into shape and volume as in Weiss 1996";
  static constexpr std::array<ParameterInfo, 3> kParameters = {{
      {"c1", "Pa", 0, true, 1e12, false, kRequired, "first Mooney-Rivlin coefficient"},
      {"c2", "Pa", 0, false, 1e12, false, 0, "second Mooney-Rivlin coefficient"},
      {"bulk_modulus", "Pa", 0, true, 1e12, false, kRequired, "bulk modulus K"},
  }};
  static constexpr bool kNeedsFibres = false;
  static constexpr bool kStiffens = false;

  explicit MooneyRivlin(std::span<const double> values) : moduli_{values[0], values[1], values[2]} {}

  template <class T>
  T EnergyAt(const Matrix3<T>& F, const Fibre<T>&) const {
    return MatrixEnergy(moduli_, IsochoricKinematics<T>(F));
  }

  template <class T>
  Matrix3<T> StressAt(const Matrix3<T>& F, const Fibre<T>&) const {
    return NearlyIncompressibleStress(moduli_, F, IsochoricKinematics<T>(F));
  }

  template <class T, class Terms>
  void AddTangentAt(const Matrix3<T>& F, const Fibre<T>&, Terms& terms) const {
    AddNearlyIncompressibleTangent(F, IsochoricKinematics<T>(F), Diagonal(T(moduli_.c1)), moduli_.c2, moduli_.bulk,
                                   terms);
  }

  double ShearModulus() const { return 2 * (moduli_.c1 + moduli_.c2); }
  double BulkModulus() const { return moduli_.bulk; }
  double VolumeModulus() const { return moduli_.bulk; }
  MooneyRivlin WithVolumeModulus(double k) const {
    MooneyRivlin law = *this;
    law.moduli_.bulk = k;
    return law;
  }

 private:
  MatrixModuli moduli_;
};
static_assert(ConstitutiveModel<MooneyRivlin>);

}  // namespace fascicle

#endif  // FASCICLE_CORE_MATERIALS_MOONEY_RIVLIN_H_
