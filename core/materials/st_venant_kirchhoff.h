#ifndef FASCICLE_CORE_MATERIALS_ST_VENANT_KIRCHHOFF_H_
#define FASCICLE_CORE_MATERIALS_ST_VENANT_KIRCHHOFF_H_

#include <span>

#include "core/materials/isotropic_moduli.h"
#include "core/materials/tangent_terms.h"

namespace fascicle {

// W = mu G:G + lambda/2 (tr G)^2 with the Green strain G = (F^T F - I)/2. Softens and collapses under strong
// compression: the stress vanishes as J goes to zero.
class StVenantKirchhoff : public LawFunctions<StVenantKirchhoff> {
 public:
  static constexpr const char* kName = "st_venant_kirchhoff";
  static constexpr const char* kTitle = "St. Venant-Kirchhoff";
  static constexpr const char* kSource = "Sifakis 2012, FEM Simulation of 3D Deformable Solids, 3.3";
  static constexpr auto kParameters = IsotropicModuli::kParameters;
  static constexpr bool kNeedsFibres = false;
  static constexpr bool kStiffens = false;

  explicit StVenantKirchhoff(std::span<const double> values) : moduli_(values) {}

  template <class T>
  T EnergyAt(const Matrix3<T>& F, const Fibre<T>&) const {
    const Matrix3<T> G = GreenStrain(F);
    const T trace = Trace(G);
    return moduli_.mu * SquaredNorm(G) + 0.5 * moduli_.lambda * trace * trace;
  }

  // P = F S.
  template <class T>
  Matrix3<T> StressAt(const Matrix3<T>& F, const Fibre<T>&) const {
    return F * SecondStress(F);
  }

  // d(F S) = dF S + F dS, dS = 2 mu dG + lambda tr(dG) I, dG = (dF^T F + F^T dF)/2.
  template <class T, class Terms>
  void AddTangentAt(const Matrix3<T>& F, const Fibre<T>&, Terms& terms) const {
    terms.Square(moduli_.lambda, F);
    terms.Right(SecondStress(F));
    terms.Transposed(moduli_.mu, F);
    terms.Left(moduli_.mu * (F * Transpose(F)));
  }

  double ShearModulus() const { return moduli_.mu; }
  double BulkModulus() const { return moduli_.Bulk(); }
  double VolumeModulus() const { return 0; }
  StVenantKirchhoff WithVolumeModulus(double) const { return *this; }

 private:
  template <class T>
  static Matrix3<T> GreenStrain(const Matrix3<T>& F) {
    return 0.5 * PlusDiagonal(Transpose(F) * F, -1);
  }

  // Second Piola-Kirchhoff stress.
  template <class T>
  Matrix3<T> SecondStress(const Matrix3<T>& F) const {
    const Matrix3<T> G = GreenStrain(F);
    return PlusDiagonal(2 * moduli_.mu * G, moduli_.lambda * Trace(G));
  }

  IsotropicModuli moduli_;
};
static_assert(ConstitutiveModel<StVenantKirchhoff>);

}  // namespace fascicle

#endif  // FASCICLE_CORE_MATERIALS_ST_VENANT_KIRCHHOFF_H_
