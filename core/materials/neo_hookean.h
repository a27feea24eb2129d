#ifndef FASCICLE_CORE_MATERIALS_NEO_HOOKEAN_H_
#define FASCICLE_CORE_MATERIALS_NEO_HOOKEAN_H_

#include <cmath>
#include <span>

#include "core/materials/isotropic_moduli.h"
#include "core/materials/tensor_algebra.h"

namespace fascicle {

// W = mu/2 (I1 - 3) - mu ln J + lambda/2 (ln J)^2 with I1 = tr(F^T F). Not finite where J <= 0.
class NeoHookean {
 public:
  static constexpr const char* kName = "neo_hookean";
  static constexpr const char* kTitle = "Neo-Hookean (compressible)";
  static constexpr const char* kSource = "Bonet & Wood 2008, Nonlinear Continuum Mechanics, compressible neo-Hookean";
  static constexpr auto kParameters = IsotropicModuli::kParameters;
  static constexpr bool kNeedsFibres = false;

  explicit NeoHookean(std::span<const double> values) : moduli_(values) {}

  double Energy(const Mat3& F, const FibreState&) const {
    const double log_J = std::log(DeterminantOf(F, Cofactor(F)));
    return 0.5 * moduli_.mu * (F.squaredNorm() - 3) - moduli_.mu * log_J + 0.5 * moduli_.lambda * log_J * log_J;
  }

  Mat3 Stress(const Mat3& F, const FibreState&) const {
    const Mat3 cofactor = Cofactor(F);
    const double J = DeterminantOf(F, cofactor);
    return moduli_.mu * F + ((moduli_.lambda * std::log(J) - moduli_.mu) / J) * cofactor;
  }

  Mat9 Tangent(const Mat3& F, const FibreState&) const {
    const Mat3 cofactor = Cofactor(F);
    const double J = DeterminantOf(F, cofactor);
    const Mat3 inverse_transpose = (1 / J) * cofactor;
    const Vec9 h = Flatten(inverse_transpose);
    Mat9 tangent = moduli_.lambda * h * h.transpose();
    tangent.diagonal().array() += moduli_.mu;
    AddTransposedProduct(moduli_.mu - moduli_.lambda * std::log(J), inverse_transpose, tangent);
    return tangent;
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
