#ifndef FASCICLE_CORE_MATERIALS_NEO_HOOKEAN_H_
#define FASCICLE_CORE_MATERIALS_NEO_HOOKEAN_H_

#include <span>

#include "core/base/numbers.h"
#include "core/materials/isotropic_moduli.h"
#include "core/materials/tangent_terms.h"

namespace fascicle {

// W = mu/2 (I1 - 3) - mu ln J + lambda/2 (ln J)^2 with I1 = tr(F^T F). Not finite where J <= 0.
class NeoHookean : public LawFunctions<NeoHookean> {
 public:
  static constexpr const char* kName = "neo_hookean";
  static constexpr const char* kTitle = "Neo-Hookean (compressible)";
  static constexpr const char* kSource = "Bonet & Wood 2008, Nonlinear Continuum Mechanics, compressible neo-Hookean";
  static constexpr auto kParameters = IsotropicModuli::kParameters;
  static constexpr bool kNeedsFibres = false;
  static constexpr bool kStiffens = false;

  explicit NeoHookean(std::span<const double> values) : moduli_(values) {}

  template <class T>
  T EnergyAt(const Matrix3<T>& F, const Fibre<T>&) const {
    const T log_J = Log(Determinant(F));
    return 0.5 * moduli_.mu * (SquaredNorm(F) - 3) - moduli_.mu * log_J + 0.5 * moduli_.lambda * log_J * log_J;
  }

  template <class T>
  Matrix3<T> StressAt(const Matrix3<T>& F, const Fibre<T>&) const {
    const Matrix3<T> cofactor = Cofactor(F);
    const T J = DeterminantOf(F, cofactor);
    return moduli_.mu * F + ((moduli_.lambda * Log(J) - moduli_.mu) / J) * cofactor;
  }

  template <class T, class Terms>
  void AddTangentAt(const Matrix3<T>& F, const Fibre<T>&, Terms& terms) const {
    const Matrix3<T> cofactor = Cofactor(F);
    const T J = DeterminantOf(F, cofactor);
    const Matrix3<T> inverse_transpose = (1 / J) * cofactor;
    terms.Square(moduli_.lambda, inverse_transpose);
    terms.Diagonal(moduli_.mu);
    terms.Transposed(moduli_.mu - moduli_.lambda * Log(J), inverse_transpose);
  }

  double ShearModulus() const { return moduli_.mu; }
  double BulkModulus() const { return moduli_.Bulk(); }
  double VolumeModulus() const { return moduli_.lambda; }
  NeoHookean WithVolumeModulus(double k) const {
    NeoHookean law = *this;
    law.moduli_.lambda = k;
    return law;
  }

 private:
  IsotropicModuli moduli_;
};
static_assert(ConstitutiveModel<NeoHookean>);

}  // namespace fascicle

#endif  // FASCICLE_CORE_MATERIALS_NEO_HOOKEAN_H_
