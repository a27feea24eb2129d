#ifndef FASCICLE_CORE_MATERIALS_MUSCLE_H_
#define FASCICLE_CORE_MATERIALS_MUSCLE_H_

#include <array>
#include <cstddef>
#include <span>

#include "core/materials/fibre_curves.h"
#include "core/materials/force_velocity.h"
#include "core/materials/isochoric.h"

namespace fascicle {

// Active skeletal muscle: transversely isotropic, nearly incompressible.
//
//   W = c1 (I1bar - 3) + c2 (I2bar - 3) + K/2 (ln J)^2 + F2(lambda, alpha)
//   lambda F2' = smax r [alpha f_act(r) f_v(v) + f_pass(r)],  r = lambda / lo,  v = (r - r_before) / (step vmax)
//
// lambda is the isochoric fibre stretch, lo the optimal stretch, smax the peak stress, vmax the maximum shortening
// velocity; f_act, f_pass and f_v are ActiveCurve, ExponentialToeCurve and ForceVelocityCurve. The rate over a step is
// implicit in F, so the stress still has a potential, that of the step; f_v = 1 where vmax or the step is zero. F2(1,
// alpha) = 0 for an isometric fibre, so that W = 0 at rest for every activation. Departs from [Teran 2003, 5] in two
// points: U = K/2 (ln J)^2, and W4 = dW/d(lambda^2), where the paper's W_lambda reads as dF2/dlambda; see README.md.
// Not finite where J <= 0.
class Muscle : public LawFunctions<Muscle> {
 public:
  static constexpr const char* kName = "muscle";
  static constexpr const char* kTitle = "Active skeletal muscle";
  static constexpr const char* kSource = "Teran 2003, section 5; Blemker, Pinsky, Delp 2005; Weiss 1996";
  static constexpr std::array<ParameterInfo, 11> kParameters = {{
      {"c1", "Pa", 0, true, 1e9, false, 500, "matrix coefficient A"},
      {"c2", "Pa", 0, false, 1e9, false, 500, "matrix coefficient B"},
      {"bulk_modulus", "Pa", 0, true, 1e12, false, 1e7, "bulk modulus K"},
      {"peak_stress", "Pa", 0, false, 1e8, false, 3e5, "peak isometric fibre stress"},
      {"optimal_stretch", "1", 0.5, false, 2, false, 1.4, "fibre stretch at which the active stress peaks"},
      {"passive_scale", "1", 0, false, 10, false, 0.05, "scale of the passive curve, relative to the peak stress"},
      {"passive_exponent", "1", 0, true, 100, false, 6.6, "exponent of the passive curve"},
      {"passive_transition", "1", 1, true, 3, false, 1.4, "normalized length from which the passive curve is a line"},
      {"max_velocity", "1/s", 0, false, 1000, false, 0, "largest shortening in optimal lengths per second; 0: no rate"},
      {"hill_curvature", "1", 0, true, 10, false, 0.25, "Hill's a over the isometric force"},
      {"eccentric_force", "1", 1, true, 5, false, 1.4, "plateau of the active stress of a lengthening fibre"},
  }};
  static constexpr bool kNeedsFibres = true;
  static constexpr bool kStiffens = true;

  // Trailing values may be omitted and take their defaults.
  explicit Muscle(std::span<const double> values)
      : moduli_{values[0], values[1], values[2]},
        peak_stress_(values[3]),
        length_per_stretch_(1 / values[4]),
        passive_(values[5], values[6], values[7]),
        max_velocity_(ValueOr(values, 8)),
        force_velocity_(ValueOr(values, 9), ValueOr(values, 10)),
        active_at_rest_(ActiveCurve::Integral(length_per_stretch_)),
        passive_at_rest_(passive_.Integral(length_per_stretch_)) {}

  template <class T>
  T EnergyAt(const Matrix3<T>& F, const Fibre<T>& fibre) const {
    const IsochoricKinematics<T> k(F);
    const T r = k.FibreStretch(fibre.direction) * length_per_stretch_;
    return MatrixEnergy(moduli_, k) + peak_stress_ * (fibre.activation * (ActiveWork(r, fibre) - active_at_rest_) +
                                                      (passive_.Integral(r) - passive_at_rest_));
  }

  template <class T>
  Matrix3<T> StressAt(const Matrix3<T>& F, const Fibre<T>& fibre) const {
    const IsochoricKinematics<T> k(F);
    const T stretch = k.FibreStretch(fibre.direction);
    const T W4 = Slope(stretch, fibre) / (2 * stretch);
    return NearlyIncompressibleStress(moduli_, F, k, W4, fibre.direction);
  }

  template <class T, class Terms>
  void AddTangentAt(const Matrix3<T>& F, const Fibre<T>& fibre, Terms& terms) const {
    const IsochoricKinematics<T> k(F);
    const T stretch = k.FibreStretch(fibre.direction);
    const FibreDerivatives<T> derivatives(stretch, Slope(stretch, fibre), Curvature(stretch, fibre));
    AddFibreTangent(F, k, moduli_, fibre.direction, derivatives, terms);
  }

  bool DependsOnRate() const { return max_velocity_ > 0; }
  double ShearModulus() const { return 2 * (moduli_.c1 + moduli_.c2); }
  double BulkModulus() const { return moduli_.bulk; }
  double VolumeModulus() const { return moduli_.bulk; }
  Muscle WithVolumeModulus(double k) const {
    Muscle law = *this;
    law.moduli_.bulk = k;
    return law;
  }

  // Cauchy stress along an isometric fibre at isochoric stretch lambda: lambda F2'(lambda, alpha) [Pa].
  double FibreStress(double stretch, double activation) const {
    return stretch * Slope(stretch, Fibre<double>{{}, activation, 1, 0});
  }

 private:
  static double ValueOr(std::span<const double> values, std::size_t index) {
    return index < values.size() ? values[index] : kParameters[index].default_value;
  }

  // Normalized velocity per unit of normalized length gained over the step; 0 where the rate is ignored.
  double VelocityPerLength(double inverse_step) const { return max_velocity_ > 0 ? inverse_step / max_velocity_ : 0; }
  // Integral of f_act f_v up to r. f_v acts during the step only; before the step the integral is that of an isometric
  // fibre.
  template <class T>
  T ActiveWork(const T& r, const Fibre<T>& fibre) const {
    const double rate = VelocityPerLength(fibre.inverse_step);
    if (rate == 0) return ActiveCurve::Integral(r);
    const T before = fibre.previous_stretch * length_per_stretch_;
    const auto work = [&](double from, double to) { return force_velocity_.ActiveWork(from, to, rate); };
    return ActiveCurve::Integral(before) + Map(work, before, r);
  }
  // The product f_act f_v.
  template <class T>
  T ActivePull(const T& r, const Fibre<T>& fibre) const {
    const double rate = VelocityPerLength(fibre.inverse_step);
    if (rate == 0) return ActiveCurve::Value(r);
    const T v = rate * (r - fibre.previous_stretch * length_per_stretch_);
    return ActiveCurve::Value(r) * force_velocity_.Value(v);
  }
  // Its derivative by r. The rate contributes a non-negative term.
  template <class T>
  T ActiveStiffness(const T& r, const Fibre<T>& fibre) const {
    const double rate = VelocityPerLength(fibre.inverse_step);
    if (rate == 0) return ActiveCurve::Derivative(r);
    const T v = rate * (r - fibre.previous_stretch * length_per_stretch_);
    return ActiveCurve::Derivative(r) * force_velocity_.Value(v) +
           ActiveCurve::Value(r) * force_velocity_.Derivative(v) * rate;
  }

  // F2'(lambda) [Pa].
  template <class T>
  T Slope(const T& stretch, const Fibre<T>& fibre) const {
    const T r = stretch * length_per_stretch_;
    return peak_stress_ * length_per_stretch_ * (fibre.activation * ActivePull(r, fibre) + passive_.Value(r));
  }
  // F2''(lambda) [Pa].
  template <class T>
  T Curvature(const T& stretch, const Fibre<T>& fibre) const {
    const T r = stretch * length_per_stretch_;
    return peak_stress_ * length_per_stretch_ * length_per_stretch_ *
           (fibre.activation * ActiveStiffness(r, fibre) + passive_.Derivative(r));
  }

  MatrixModuli moduli_;
  double peak_stress_;         // smax [Pa]
  double length_per_stretch_;  // 1 / lo
  ExponentialToeCurve passive_;
  double max_velocity_;  // vmax [1/s]
  ForceVelocityCurve force_velocity_;
  double active_at_rest_, passive_at_rest_;  // integrals of the curves up to lambda = 1
};
static_assert(ConstitutiveModel<Muscle>);

}  // namespace fascicle

#endif  // FASCICLE_CORE_MATERIALS_MUSCLE_H_
