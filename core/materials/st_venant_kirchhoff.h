#ifndef FASCICLE_CORE_MATERIALS_ST_VENANT_KIRCHHOFF_H_
#define FASCICLE_CORE_MATERIALS_ST_VENANT_KIRCHHOFF_H_

#include <span>

#include "core/materials/isotropic_moduli.h"
#include "core/materials/tensor_algebra.h"

namespace fascicle {

// W = mu G:G + lambda/2 (tr G)^2 with the Green strain G = (F^T F - I)/2. Softens and collapses under strong
// compression: its stress vanishes again as J goes to zero.
class StVenantKirchhoff {
 public:
  static constexpr const char* kName = "st_venant_kirchhoff";
  static constexpr const char* kTitle = "St. Venant-Kirchhoff";
  static constexpr const char* kSource = "Sifakis 2012, FEM Simulation of 3D Deformable Solids, 3.3";
  static constexpr auto kParameters = IsotropicModuli::kParameters;
  static constexpr bool kNeedsFibres = false;

  explicit StVenantKirchhoff(std::span<const double> values) : moduli_(values) {}

  double Energy(const Mat3& F, const FibreState&) const {
    const Mat3 G = GreenStrain(F);
    const double trace = G.trace();
    return moduli_.mu * G.squaredNorm() + 0.5 * moduli_.lambda * trace * trace;
  }

  // P = F S.
  Mat3 Stress(const Mat3& F, const FibreState&) const { return F * SecondStress(F); }

  // d(F S) = dF S + F dS, dS = 2 mu dG + lambda tr(dG) I, dG = (dF^T F + F^T dF)/2.
  Mat9 Tangent(const Mat3& F, const FibreState&) const {
    const Vec9 f = Flatten(F);
    Mat9 tangent = moduli_.lambda * f * f.transpose();
    AddRightProduct(1, SecondStress(F), tangent);
    AddTransposedProduct(moduli_.mu, F, tangent);
    AddLeftProduct(moduli_.mu, F * F.transpose(), tangent);
    return tangent;
  }

  double ShearModulus() const { return moduli_.mu; }
  double BulkModulus() const { return moduli_.Bulk(); }
  double VolumeModulus() const { return 0; }
  StVenantKirchhoff WithVolumeModulus(double) const { return *this; }

 private:
  static Mat3 GreenStrain(const Mat3& F) { return 0.5 * (F.transpose() * F - Mat3::Identity()); }

  // Second Piola-Kirchhoff stress.
  Mat3 SecondStress(const Mat3& F) const {
    const Mat3 G = GreenStrain(F);
    return 2 * moduli_.mu * G + moduli_.lambda * G.trace() * Mat3::Identity();
  }

  IsotropicModuli moduli_;
};
static_assert(ConstitutiveModel<StVenantKirchhoff>);

}  // namespace fascicle

#endif  // FASCICLE_CORE_MATERIALS_ST_VENANT_KIRCHHOFF_H_
