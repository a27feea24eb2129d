#ifndef FASCICLE_CORE_MATERIALS_HOLZAPFEL_GASSER_OGDEN_H_
#define FASCICLE_CORE_MATERIALS_HOLZAPFEL_GASSER_OGDEN_H_

#include <array>
#include <cmath>
#include <span>

#include "core/materials/fibre_curves.h"
#include "core/materials/isochoric.h"

namespace fascicle {

// Two families of passive fibres with dispersed directions, as in the walls of arteries:
//
//   W = c/2 (I1bar - 3) + K/2 (ln J)^2 + sum over i = 1, 2 of k1/(2 k2) (exp(k2 <E_i>^2) - 1)
//   E_i = kappa (I1bar - 3) + (1 - 3 kappa) (I4bar_i - 1),  <E> = max(E, 0)
//
// I4bar_i is the square of the isochoric stretch along a_i = cos(gamma) a0 +- sin(gamma) b. a0 is the body's fibre
// direction, in the middle between the families; b is the unit vector perpendicular to a0 in the plane of a0 and the
// reference direction, which is the same in the whole body. In a vessel with fibre directions around its axis, the
// reference direction is the axis. With gamma = 0 both families run along a0 and there is no reference direction.
//
// kappa = 0: all fibres of a family are parallel; kappa = 1/3: they have all directions alike. Not finite where J <= 0.
class HolzapfelGasserOgden : public LawFunctions<HolzapfelGasserOgden> {
 public:
  static constexpr const char* kName = "holzapfel_gasser_ogden";
  static constexpr const char* kTitle = "Holzapfel-Gasser-Ogden (two families of dispersed fibres)";
  static constexpr const char* kSource =
      "Gasser, Ogden, Holzapfel 2006, Hyperelastic modelling of arterial layers with distributed collagen fibre "
      "orientations";
  static constexpr double kRightAngle = 1.5707963267948966;
  static constexpr std::array<ParameterInfo, 9> kParameters = {{
      {"c", "Pa", 0, true, 1e12, false, kRequired, "shear modulus of the matrix"},
      {"k1", "Pa", 0, false, 1e12, false, kRequired, "stiffness of a family at small strain"},
      {"k2", "1", 0, false, 1e6, false, kRequired, "exponent of the fibres; 0: quadratic in E"},
      {"kappa", "1", 0, false, 1.0 / 3, false, 0, "dispersion: 0 parallel fibres, 1/3 all directions alike"},
      {"gamma", "rad", 0, false, kRightAngle, false, kRequired, "angle between each family and the fibre direction"},
      {"reference_x", "1", -1e6, false, 1e6, false, 0, "reference direction, which spans the plane of the families"},
      {"reference_y", "1", -1e6, false, 1e6, false, 0, "its y component"},
      {"reference_z", "1", -1e6, false, 1e6, false, 0, "its z component"},
      {"bulk_modulus", "Pa", 0, true, 1e12, false, kRequired, "bulk modulus K"},
  }};
  static constexpr bool kNeedsFibres = true;
  static constexpr bool kStiffens = true;

  explicit HolzapfelGasserOgden(std::span<const double> values)
      : c_(values[0]),
        curve_{values[1], values[2]},
        kappa_(values[3]),
        cosine_(std::cos(values[4])),
        sine_(std::sin(values[4])),
        reference_{values[5], values[6], values[7]},
        bulk_(values[8]) {
    const double length = std::hypot(values[5], values[6], values[7]);
    for (double& component : reference_) component /= length > 0 ? length : 1;
  }

  template <class T>
  T EnergyAt(const Matrix3<T>& F, const Fibre<T>& fibre) const {
    const IsochoricKinematics<T> k(F);
    T energy = 0.5 * c_ * (k.scale * k.I1 - 3) + 0.5 * bulk_ * k.log_J * k.log_J;
    for (const double side : {1.0, -1.0}) energy += curve_.Energy(Strain(k, Structure(fibre.direction, side)));
    return energy;
  }

  template <class T>
  Matrix3<T> StressAt(const Matrix3<T>& F, const Fibre<T>& fibre) const {
    const IsochoricKinematics<T> k(F);
    Matrix3<T> N = Diagonal(T(0.5 * c_));
    for (const double side : {1.0, -1.0}) {
      const Matrix3<T> H = Structure(fibre.direction, side);
      N = N + curve_.Derivative(Strain(k, H)) * H;
    }
    return StressOfInvariants(F, k, N, bulk_);
  }

  template <class T, class Terms>
  void AddTangentAt(const Matrix3<T>& F, const Fibre<T>& fibre, Terms& terms) const {
    const IsochoricKinematics<T> k(F);
    Matrix3<T> N = Diagonal(T(0.5 * c_));
    for (const double side : {1.0, -1.0}) {
      const Matrix3<T> H = Structure(fibre.direction, side);
      const T E = Strain(k, H);
      N = N + curve_.Derivative(E) * H;
      terms.Square(curve_.SecondDerivative(E), InvariantGradient(F, k, H));
    }
    AddTangentOfInvariants(F, k, N, bulk_, terms);
  }

  double ShearModulus() const { return c_; }
  double BulkModulus() const { return bulk_; }
  double VolumeModulus() const { return bulk_; }
  HolzapfelGasserOgden WithVolumeModulus(double k) const {
    HolzapfelGasserOgden law = *this;
    law.bulk_ = k;
    return law;
  }

  // The unit reference direction; zero if none is given or, with gamma = 0, none is needed.
  Vec3 ReferenceDirection() const { return sine_ == 0 ? Vec3::Zero() : Vec3(reference_.data()); }
  // Whether the families are defined where the fibre direction is the unit vector a0: it is at least 0.1 degrees from
  // the reference direction, or gamma is 0.
  bool HasFamiliesAt(const Vec3& a0) const {
    return sine_ == 0 || Vec3(reference_.data()).cross(a0).norm() >= kLeastSine;
  }

 private:
  static constexpr double kLeastSine = 1.7e-3;

  // kappa I + (1 - 3 kappa) a_i a_i^T. Finite even where the families are not defined.
  template <class T>
  Matrix3<T> Structure(const Vector3<T>& a0, double side) const {
    Vector3<T> a = a0;
    if (sine_ != 0) {
      const T along = reference_[0] * a0[0] + reference_[1] * a0[1] + reference_[2] * a0[2];
      Vector3<T> b;
      for (int i = 0; i < 3; ++i) b[i] = reference_[i] - along * a0[i];
      const T square = Dot(b, b);
      const T scale = Select(square > 1e-12, side * sine_ / Sqrt(square), 0);
      for (int i = 0; i < 3; ++i) a[i] = cosine_ * a0[i] + scale * b[i];
    }
    return PlusDiagonal(ScaledSquare(1 - 3 * kappa_, a), kappa_);
  }

  // E = Cbar:H - 1, exactly zero at rest.
  template <class T>
  static T Strain(const IsochoricKinematics<T>& k, const Matrix3<T>& H) {
    return k.scale * Contract(PlusDiagonal(k.C, -1), H) + (k.scale - 1);
  }

  double c_;                         // [Pa]
  FungCurve curve_;                  // of a family
  double kappa_;                     // dispersion
  double cosine_, sine_;             // of gamma
  std::array<double, 3> reference_;  // unit vector, or zero
  double bulk_;                      // [Pa]
};
static_assert(ConstitutiveModel<HolzapfelGasserOgden>);

}  // namespace fascicle

#endif  // FASCICLE_CORE_MATERIALS_HOLZAPFEL_GASSER_OGDEN_H_
