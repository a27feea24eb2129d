#ifndef FASCICLE_CORE_MATERIALS_YEOH_H_
#define FASCICLE_CORE_MATERIALS_YEOH_H_

#include <array>
#include <span>

#include "core/materials/isochoric.h"

namespace fascicle {

// W = c1 x + c2 x^2 + c3 x^3 + K/2 (ln J)^2, x = I1bar - 3. Not finite where J <= 0.
//
// c2 and c3 may be negative: filled rubber typically has c2 < 0 < c3. The stress rises with every stretch where
// W' = c1 + 2 c2 x + 3 c3 x^2 > 0; that is, everywhere if c3 >= 0 and c2 > -sqrt(3 c1 c3). Elsewhere the material
// softens until no static solution exists.
class Yeoh : public LawFunctions<Yeoh> {
 public:
  static constexpr const char* kName = "yeoh";
  static constexpr const char* kTitle = "Yeoh (nearly incompressible)";
  static constexpr const char* kSource = "Yeoh 1993, Some forms of the strain energy function for rubber";
  static constexpr std::array<ParameterInfo, 4> kParameters = {{
      {"c1", "Pa", 0, true, 1e12, false, kRequired, "coefficient of I1bar - 3; half of the shear modulus"},
      {"c2", "Pa", -1e12, false, 1e12, false, 0, "coefficient of (I1bar - 3)^2"},
      {"c3", "Pa", -1e12, false, 1e12, false, 0, "coefficient of (I1bar - 3)^3"},
      {"bulk_modulus", "Pa", 0, true, 1e12, false, kRequired, "bulk modulus K"},
  }};
  static constexpr bool kNeedsFibres = false;
  static constexpr bool kStiffens = true;

  explicit Yeoh(std::span<const double> values) : c1_(values[0]), c2_(values[1]), c3_(values[2]), bulk_(values[3]) {}

  template <class T>
  T EnergyAt(const Matrix3<T>& F, const Fibre<T>&) const {
    const IsochoricKinematics<T> k(F);
    const T x = k.scale * k.I1 - 3;
    return x * (c1_ + x * (c2_ + c3_ * x)) + 0.5 * bulk_ * k.log_J * k.log_J;
  }

  template <class T>
  Matrix3<T> StressAt(const Matrix3<T>& F, const Fibre<T>&) const {
    const IsochoricKinematics<T> k(F);
    return StressOfInvariants(F, k, Diagonal(Slope<T>(k.scale * k.I1 - 3)), bulk_);
  }

  template <class T, class Terms>
  void AddTangentAt(const Matrix3<T>& F, const Fibre<T>&, Terms& terms) const {
    const IsochoricKinematics<T> k(F);
    const T x = k.scale * k.I1 - 3;
    AddTangentOfInvariants(F, k, Diagonal(Slope<T>(x)), bulk_, terms);
    terms.Square(2 * c2_ + 6 * c3_ * x, InvariantGradient(F, k, Diagonal(T(1.0))));
  }

  double ShearModulus() const { return 2 * c1_; }
  double BulkModulus() const { return bulk_; }
  double VolumeModulus() const { return bulk_; }
  Yeoh WithVolumeModulus(double k) const {
    Yeoh law = *this;
    law.bulk_ = k;
    return law;
  }

 private:
  // dW/dI1bar at x = I1bar - 3.
  template <class T>
  T Slope(const T& x) const {
    return c1_ + x * (2 * c2_ + 3 * c3_ * x);
  }

  double c1_, c2_, c3_, bulk_;  // [Pa]
};
static_assert(ConstitutiveModel<Yeoh>);

}  // namespace fascicle

#endif  // FASCICLE_CORE_MATERIALS_YEOH_H_
