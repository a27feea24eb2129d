#ifndef FASCICLE_CORE_MATERIALS_LINEAR_ELASTIC_H_
#define FASCICLE_CORE_MATERIALS_LINEAR_ELASTIC_H_

#include <span>

#include "core/materials/isotropic_moduli.h"
#include "core/materials/tensor_algebra.h"

namespace fascicle {

// W = mu e:e + lambda/2 (tr e)^2 with the small strain e = (F + F^T)/2 - I. A rotation strains it: for checks and small
// deflections only.
class LinearElastic {
 public:
  static constexpr const char* kName = "linear_elastic";
  static constexpr const char* kTitle = "Linear elastic (small strain)";
  static constexpr const char* kSource = "Hooke's law; Sifakis 2012, FEM Simulation of 3D Deformable Solids, 3.2";
  static constexpr auto kParameters = IsotropicModuli::kParameters;
  static constexpr bool kNeedsFibres = false;

  explicit LinearElastic(std::span<const double> values) : moduli_(values) {}

  double Energy(const Mat3& F, const FibreState&) const {
    const Mat3 e = Strain(F);
    const double trace = e.trace();
    return moduli_.mu * e.squaredNorm() + 0.5 * moduli_.lambda * trace * trace;
  }

  Mat3 Stress(const Mat3& F, const FibreState&) const {
    const Mat3 e = Strain(F);
    return 2 * moduli_.mu * e + moduli_.lambda * e.trace() * Mat3::Identity();
  }

  Mat9 Tangent(const Mat3&, const FibreState&) const {
    Mat9 tangent = moduli_.mu * Mat9::Identity();
    AddTransposedProduct(moduli_.mu, Mat3::Identity(), tangent);
    const Vec9 identity = Flatten(Mat3::Identity());
    tangent += moduli_.lambda * identity * identity.transpose();
    return tangent;
  }

  double ShearModulus() const { return moduli_.mu; }
  double BulkModulus() const { return moduli_.Bulk(); }
  double VolumeModulus() const { return 0; }
  LinearElastic WithVolumeModulus(double) const { return *this; }

 private:
  static Mat3 Strain(const Mat3& F) { return 0.5 * (F + F.transpose()) - Mat3::Identity(); }

  IsotropicModuli moduli_;
};
static_assert(ConstitutiveModel<LinearElastic>);

}  // namespace fascicle

#endif  // FASCICLE_CORE_MATERIALS_LINEAR_ELASTIC_H_
