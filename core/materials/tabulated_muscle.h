#ifndef FASCICLE_CORE_MATERIALS_TABULATED_MUSCLE_H_
#define FASCICLE_CORE_MATERIALS_TABULATED_MUSCLE_H_

#include <array>
#include <memory>
#include <span>
#include <utility>

#include "core/materials/isochoric.h"
#include "core/materials/muscle_curves.h"

namespace fascicle {

// Active skeletal muscle with curves of the user's own or of a published set, in a Yeoh matrix.
//
//   W = c1 x + c2 x^2 + c3 x^3 + K/2 (ln J)^2 + F2(lambda, alpha),  x = I1bar - 3
//   lambda F2' = smax m [alpha f_act(r) f_v(v) + f_pass(r)],  r = lambda / lo,  v = (r - r_before) / (step vmax)
//
// lambda is the isochoric fibre stretch, lo the optimal stretch, smax the peak stress, vmax the maximum shortening
// velocity; f_v = 1 where vmax or the step is zero, as in `Muscle`. m = r where the curves are forces, 1 where they
// are Cauchy stresses (CurveStress). F2(1, alpha) = 0 for an isometric fibre. Not finite where J <= 0.
class TabulatedMuscle : public LawFunctions<TabulatedMuscle> {
 public:
  static constexpr const char* kName = "tabulated_muscle";
  static constexpr const char* kTitle = "Active skeletal muscle with tabulated curves";
  static constexpr const char* kSource = "Thelen 2003; De Groote 2016; Almonacid 2024; Yeoh 1993";
  static constexpr std::array<ParameterInfo, 7> kParameters = {{
      {"c1", "Pa", 0, true, 1e12, false, 1000, "coefficient of I1bar - 3; half of the matrix's shear modulus"},
      {"c2", "Pa", -1e12, false, 1e12, false, 0, "coefficient of (I1bar - 3)^2"},
      {"c3", "Pa", -1e12, false, 1e12, false, 0, "coefficient of (I1bar - 3)^3"},
      {"bulk_modulus", "Pa", 0, true, 1e12, false, 1e7, "bulk modulus K"},
      {"peak_stress", "Pa", 0, false, 1e8, false, 3e5, "stress where a curve is 1"},
      {"optimal_stretch", "1", 0.5, false, 2, false, 1, "fibre stretch at which the curves' normalized length is 1"},
      {"max_velocity", "1/s", 0, false, 1000, false, 0, "largest shortening in optimal lengths per second; 0: no rate"},
  }};
  static constexpr bool kNeedsFibres = true;
  static constexpr bool kStiffens = true;

  // With the curves of Thelen 2003.
  explicit TabulatedMuscle(std::span<const double> values)
      : TabulatedMuscle(values, std::make_shared<const MuscleCurves>(CurvesOf(PublishedCurves::kThelen2003))) {}
  TabulatedMuscle(std::span<const double> values, std::shared_ptr<const MuscleCurves> curves)
      : numbers_{values[0], values[1], values[2], values[3], values[4], 1 / values[5], values[6]},
        curves_(curves.get()),
        owner_(std::move(curves)) {
    numbers_.active_at_rest = ActiveIntegral(numbers_.length_per_stretch);
    numbers_.passive_at_rest = PassiveIntegral(numbers_.length_per_stretch);
  }

  template <class T>
  T EnergyAt(const Matrix3<T>& F, const Fibre<T>& fibre) const {
    const IsochoricKinematics<T> k(F);
    const T x = k.scale * k.I1 - 3;
    const T r = k.FibreStretch(fibre.direction) * numbers_.length_per_stretch;
    const T passive = Map([this](double length) { return PassiveIntegral(length); }, r) - numbers_.passive_at_rest;
    const T active = ActiveWork(r, fibre) - numbers_.active_at_rest;
    return x * (numbers_.c1 + x * (numbers_.c2 + numbers_.c3 * x)) + 0.5 * numbers_.bulk * k.log_J * k.log_J +
           numbers_.peak_stress * (fibre.activation * active + passive);
  }

  template <class T>
  Matrix3<T> StressAt(const Matrix3<T>& F, const Fibre<T>& fibre) const {
    const IsochoricKinematics<T> k(F);
    const T stretch = k.FibreStretch(fibre.direction);
    const T W4 = DerivativesAt(stretch, fibre).first / (2 * stretch);
    return StressOfInvariants(F, k, Weight<T>(k.scale * k.I1 - 3, W4, fibre.direction), numbers_.bulk);
  }

  template <class T, class Terms>
  void AddTangentAt(const Matrix3<T>& F, const Fibre<T>& fibre, Terms& terms) const {
    const Vector3<T>& a0 = fibre.direction;
    const IsochoricKinematics<T> k(F);
    const T x = k.scale * k.I1 - 3, stretch = k.FibreStretch(a0);
    const Derivatives<T> of_fibre = DerivativesAt(stretch, fibre);
    const FibreDerivatives<T> d(stretch, of_fibre.first, of_fibre.second);
    AddTangentOfInvariants(F, k, Weight(x, d.W4, a0), numbers_.bulk, terms);
    terms.Square(2 * numbers_.c2 + 6 * numbers_.c3 * x, InvariantGradient(F, k, Diagonal(T(1.0))));
    terms.Square(d.W44, FibreStretchSquaredGradient(F, k, a0));
  }

  bool DependsOnRate() const { return numbers_.max_velocity > 0; }
  double ShearModulus() const { return 2 * numbers_.c1; }
  double BulkModulus() const { return numbers_.bulk; }
  double VolumeModulus() const { return numbers_.bulk; }
  TabulatedMuscle WithVolumeModulus(double k) const {
    TabulatedMuscle law = *this;
    law.numbers_.bulk = k;
    return law;
  }

  // Cauchy stress along an isometric fibre at isochoric stretch lambda: lambda F2'(lambda, alpha) [Pa].
  double FibreStress(double stretch, double activation) const {
    return stretch * DerivativesAt(stretch, Fibre<double>{{}, activation, 1, 0}).first;
  }

  // All that the law consists of.
  struct Numbers {
    double c1, c2, c3, bulk;                         // [Pa]
    double peak_stress;                              // smax [Pa]
    double length_per_stretch;                       // 1 / lo
    double max_velocity;                             // vmax [1/s]
    double active_at_rest = 0, passive_at_rest = 0;  // integrals of the curves up to lambda = 1
  };
  const Numbers& numbers() const { return numbers_; }
  const MuscleCurves& curves() const { return *curves_; }

 private:
  template <class T>
  struct Derivatives {
    T first, second;
  };

  // N = dW/dI1bar I + W4 a0 a0^T at x = I1bar - 3.
  template <class T>
  Matrix3<T> Weight(const T& x, const T& W4, const Vector3<T>& a0) const {
    return PlusDiagonal(ScaledSquare(W4, a0), numbers_.c1 + x * (2 * numbers_.c2 + 3 * numbers_.c3 * x));
  }

  double ActiveIntegral(double r) const {
    const PointCurve& f = curves_->active_length;
    return curves_->stress == CurveStress::kCauchy ? f.IntegralOverArgument(r) : f.Integral(r);
  }
  double PassiveIntegral(double r) const {
    const PointCurve& f = curves_->passive_length;
    return curves_->stress == CurveStress::kCauchy ? f.IntegralOverArgument(r) : f.Integral(r);
  }
  // Normalized velocity per unit of normalized length gained over the step; 0 where the rate is ignored.
  double VelocityPerLength(double inverse_step) const {
    return numbers_.max_velocity > 0 ? inverse_step / numbers_.max_velocity : 0;
  }
  // Integral of the active curve up to r. f_v acts during the step only.
  template <class T>
  T ActiveWork(const T& r, const Fibre<T>& fibre) const {
    const auto isometric = [this](double length) { return ActiveIntegral(length); };
    const double rate = VelocityPerLength(fibre.inverse_step);
    if (rate == 0) return Map(isometric, r);
    const T before = fibre.previous_stretch * numbers_.length_per_stretch;
    const auto work = [&](double from, double to) { return curves_->ActiveWork(from, to, rate); };
    return Map(isometric, before) + Map(work, before, r);
  }

  // F2' and F2'' by lambda [Pa].
  template <class T>
  Derivatives<T> DerivativesAt(const T& stretch, const Fibre<T>& fibre) const {
    const double per_stretch = numbers_.length_per_stretch;
    const T r = stretch * per_stretch;
    const PointCurve::Point<T> passive = curves_->passive_length.At(r);
    PointCurve::Point<T> active = curves_->active_length.At(r);
    const double rate = VelocityPerLength(fibre.inverse_step);
    if (rate != 0) {
      const T v = rate * (r - fibre.previous_stretch * per_stretch);
      const PointCurve::Point<T> of_velocity = curves_->force_velocity.At(v);
      active.slope = active.slope * of_velocity.value + active.value * of_velocity.slope * rate;
      active.value = active.value * of_velocity.value;
    }
    const T value = numbers_.peak_stress * (fibre.activation * active.value + passive.value);
    const T slope = numbers_.peak_stress * per_stretch * (fibre.activation * active.slope + passive.slope);
    if (curves_->stress == CurveStress::kForce) return {per_stretch * value, per_stretch * slope};
    const T first = value / stretch;
    return {first, (slope - first) / stretch};
  }

  Numbers numbers_;
  const MuscleCurves* curves_;  // of owner_: kernels call nothing of the standard library
  std::shared_ptr<const MuscleCurves> owner_;
};
static_assert(ConstitutiveModel<TabulatedMuscle>);

}  // namespace fascicle

#endif  // FASCICLE_CORE_MATERIALS_TABULATED_MUSCLE_H_
