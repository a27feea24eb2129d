#ifndef FASCICLE_CORE_MATERIALS_CONSTITUTIVE_MODEL_H_
#define FASCICLE_CORE_MATERIALS_CONSTITUTIVE_MODEL_H_

#include <concepts>
#include <limits>
#include <span>

#include "core/base/matrix3.h"
#include "core/base/types.h"

namespace fascicle {

// Arguments of a law besides the deformation gradient.
struct FibreState {
  // Rest direction a0, times the prestretch: the fibres' stretch at rest, which multiplies their stretch. Ignored by
  // isotropic laws.
  Vec3 direction = Vec3::Zero();
  double activation = 0;  // alpha in [0, 1]; ignored by passive laws
  // For laws that depend on the fibre's rate: the isochoric stretch one step ago [1] and the inverse of that step's
  // length [1/s], zero for an isometric fibre.
  double previous_stretch = 1;
  double inverse_step = 0;
};

// The same for numbers or Lanes.
template <class T>
struct Fibre {
  Vector3<T> direction;
  T activation;
  T previous_stretch;
  double inverse_step;
};

inline Matrix3<double> ToNumbers(const Mat3& a) {
  Matrix3<double> r;
  for (int k = 0; k < 9; ++k) r.m[k] = a.data()[k];
  return r;
}
inline Mat3 ToEigen(const Matrix3<double>& a) { return Mat3(a.m); }
inline Fibre<double> ToNumbers(const FibreState& f) {
  return {{{f.direction[0], f.direction[1], f.direction[2]}}, f.activation, f.previous_stretch, f.inverse_step};
}

// The public functions of a law for one F. They follow from the law's formulas, which are members of the class
//
//   template <class T> T EnergyAt(const Matrix3<T>& F, const Fibre<T>& fibre) const;
//   template <class T> Matrix3<T> StressAt(const Matrix3<T>& F, const Fibre<T>& fibre) const;
//   template <class T, class Terms> void AddTangentAt(const Matrix3<T>& F, const Fibre<T>& fibre, Terms& terms) const;
//
// and are written once for single numbers and for many elements side by side (see numbers.h and tangent_terms.h).
// Defined for the laws of the list in material.cc.
template <class Law>
class LawFunctions {
 public:
  double Energy(const Mat3& F, const FibreState& fibre) const;
  Mat3 Stress(const Mat3& F, const FibreState& fibre) const;
  Mat9 Tangent(const Mat3& F, const FibreState& fibre) const;
};

// A parameter of a law, as in the message of the same name in scene.proto.
struct ParameterInfo {
  const char* name;      // field name in scene.proto
  const char* unit;      // "Pa", "1"
  double min;            // smallest value
  bool min_open;         // whether min itself is excluded
  double max;            // largest value
  bool max_open;         // whether max itself is excluded
  double default_value;  // NaN: required
  const char* meaning;
};
inline constexpr double kRequired = std::numeric_limits<double>::quiet_NaN();

// A constitutive law: pure functions of F. Values in SI units; W per rest volume.
//   kName        name in scene.proto (`neo_hookean`)
//   kTitle       name for messages and tables
//   kSource      paper and equation
//   kParameters  std::array<ParameterInfo, n>
//   kNeedsFibres whether the law requires fibre directions
//   kStiffens    whether the tangent of a stretched material may be many times that at rest
//   VolumeModulus, WithVolumeModulus
//                the coefficient k of the term k/2 (ln J)^2 of W, and the same law with another k (of any sign), so
//                that a method can evaluate part of that term elsewhere. Laws without the term return 0 and themselves.
// Constructed from the values of its parameters in the order of kParameters.
// Where J <= 0, a law that is undefined there returns non-finite values; it never traps.
template <class M>
concept ConstitutiveModel = requires(const M m, const Mat3& F, const FibreState& fibre,
                                     std::span<const double> values) {
  { M::kName } -> std::convertible_to<const char*>;
  { M::kTitle } -> std::convertible_to<const char*>;
  { M::kSource } -> std::convertible_to<const char*>;
  { M::kNeedsFibres } -> std::convertible_to<bool>;
  { M::kStiffens } -> std::convertible_to<bool>;
  {std::span<const ParameterInfo>(M::kParameters)};
  M(values);
  { m.Energy(F, fibre) } -> std::same_as<double>;  // W [J/m^3]
  { m.Stress(F, fibre) } -> std::same_as<Mat3>;    // P = dW/dF, first Piola-Kirchhoff [Pa]
  { m.Tangent(F, fibre) } -> std::same_as<Mat9>;   // dP/dF, symmetric [Pa]
  { m.ShearModulus() } -> std::same_as<double>;    // small-strain, passive, without fibres [Pa]
  { m.BulkModulus() } -> std::same_as<double>;     // small-strain [Pa]
  { m.VolumeModulus() } -> std::same_as<double>;   // [Pa]
  { m.WithVolumeModulus(0.0) } -> std::same_as<M>;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_MATERIALS_CONSTITUTIVE_MODEL_H_
