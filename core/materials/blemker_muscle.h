#ifndef FASCICLE_CORE_MATERIALS_BLEMKER_MUSCLE_H_
#define FASCICLE_CORE_MATERIALS_BLEMKER_MUSCLE_H_

#include <array>
#include <span>

#include "core/materials/fibre_curves.h"
#include "core/materials/shear_invariants.h"

namespace fascicle {

// Blemker's muscle with its own matrix, whose energy depends on shear along and across the fibres:
//
//   W = G1 B1^2 + G2 B2^2 + K/2 (ln J)^2 + F2(lambda, alpha)
//   lambda F2' = smax r [alpha f_act(r) + f_pass(r)],  r = lambda / lo
//
// Curves as in `Muscle`, invariants as in shear_invariants.h. Not finite where J <= 0.
class BlemkerMuscle : public LawFunctions<BlemkerMuscle> {
 public:
  static constexpr const char* kName = "blemker_muscle";
  static constexpr const char* kTitle = "Active skeletal muscle with shear along and across its fibres";
  static constexpr const char* kSource = "Blemker, Pinsky, Delp 2005; Criscione, Douglas, Hunter 2001";
  static constexpr std::array<ParameterInfo, 8> kParameters = {{
      {"along_modulus", "Pa", 0, true, 1e9, false, 500, "G1: half of the shear modulus along the fibres"},
      {"across_modulus", "Pa", 0, true, 1e9, false, 500, "G2: half of the shear modulus across the fibres"},
      {"bulk_modulus", "Pa", 0, true, 1e12, false, 1e7, "bulk modulus K"},
      {"peak_stress", "Pa", 0, false, 1e8, false, 3e5, "peak isometric fibre stress"},
      {"optimal_stretch", "1", 0.5, false, 2, false, 1.4, "fibre stretch at which the active stress peaks"},
      {"passive_scale", "1", 0, false, 10, false, 0.05, "scale of the passive curve, relative to the peak stress"},
      {"passive_exponent", "1", 0, true, 100, false, 6.6, "exponent of the passive curve"},
      {"passive_transition", "1", 1, true, 3, false, 1.4, "normalized length from which the passive curve is a line"},
  }};
  static constexpr bool kNeedsFibres = true;
  static constexpr bool kStiffens = true;

  explicit BlemkerMuscle(std::span<const double> values)
      : moduli_{values[0], values[1], values[2]},
        peak_stress_(values[3]),
        length_per_stretch_(1 / values[4]),
        passive_(values[5], values[6], values[7]),
        active_at_rest_(ActiveCurve::Integral(length_per_stretch_)),
        passive_at_rest_(passive_.Integral(length_per_stretch_)) {}

  template <class T>
  T EnergyAt(const Matrix3<T>& F, const Fibre<T>& fibre) const {
    const ShearKinematics<T> k(F, fibre.direction);
    const T r = k.FibreStretch() * length_per_stretch_;
    return k.MatrixEnergy(moduli_) + peak_stress_ * (fibre.activation * (ActiveCurve::Integral(r) - active_at_rest_) +
                                                     (passive_.Integral(r) - passive_at_rest_));
  }

  template <class T>
  Matrix3<T> StressAt(const Matrix3<T>& F, const Fibre<T>& fibre) const {
    const ShearKinematics<T> k(F, fibre.direction);
    return k.Stress(moduli_, Slope(k.FibreStretch(), fibre.activation));
  }

  template <class T, class Terms>
  void AddTangentAt(const Matrix3<T>& F, const Fibre<T>& fibre, Terms& terms) const {
    const ShearKinematics<T> k(F, fibre.direction);
    const T r = k.FibreStretch() * length_per_stretch_;
    const T curvature = peak_stress_ * length_per_stretch_ * length_per_stretch_ *
                        (fibre.activation * ActiveCurve::Derivative(r) + passive_.Derivative(r));
    k.AddTangent(moduli_, Slope(k.FibreStretch(), fibre.activation), curvature, terms);
  }

  double ShearModulus() const { return 2 * (moduli_.along > moduli_.across ? moduli_.along : moduli_.across); }
  double ShearModulusAlong() const { return 2 * moduli_.along; }
  double ShearModulusAcross() const { return 2 * moduli_.across; }
  double BulkModulus() const { return moduli_.bulk; }
  double VolumeModulus() const { return moduli_.bulk; }
  BlemkerMuscle WithVolumeModulus(double k) const {
    BlemkerMuscle law = *this;
    law.moduli_.bulk = k;
    return law;
  }

  // Cauchy stress along the fibre at isochoric stretch lambda: lambda F2'(lambda, alpha) [Pa].
  double FibreStress(double stretch, double activation) const { return stretch * Slope(stretch, activation); }

 private:
  // F2'(lambda) [Pa].
  template <class T>
  T Slope(const T& stretch, const T& activation) const {
    const T r = stretch * length_per_stretch_;
    return peak_stress_ * length_per_stretch_ * (activation * ActiveCurve::Value(r) + passive_.Value(r));
  }

  ShearModuli moduli_;
  double peak_stress_;         // smax [Pa]
  double length_per_stretch_;  // 1 / lo
  ExponentialToeCurve passive_;
  double active_at_rest_, passive_at_rest_;  // integrals of the curves up to lambda = 1
};
static_assert(ConstitutiveModel<BlemkerMuscle>);

}  // namespace fascicle

#endif  // FASCICLE_CORE_MATERIALS_BLEMKER_MUSCLE_H_
