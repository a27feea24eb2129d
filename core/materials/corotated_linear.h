#ifndef FASCICLE_CORE_MATERIALS_COROTATED_LINEAR_H_
#define FASCICLE_CORE_MATERIALS_COROTATED_LINEAR_H_

#include <span>

#include "core/materials/isotropic_moduli.h"
#include "core/materials/rotation.h"
#include "core/materials/tensor_algebra.h"

namespace fascicle {

// W = mu |F - R|^2 + lambda/2 tr(R^T F - I)^2 with R the rotation nearest to F. Finite for every finite F; where two of
// the singular values (the least taken with the sign of J) sum to zero R is not unique and the tangent is not finite.
class CorotatedLinear {
 public:
  static constexpr const char* kName = "corotated_linear";
  static constexpr const char* kTitle = "Corotated linear";
  static constexpr const char* kSource = "Sifakis 2012, FEM Simulation of 3D Deformable Solids, 3.4";
  static constexpr auto kParameters = IsotropicModuli::kParameters;
  static constexpr bool kNeedsFibres = false;

  explicit CorotatedLinear(std::span<const double> values) : moduli_(values) {}

  double Energy(const Mat3& F, const FibreState&) const {
    const Mat3 R = NearestRotation(F);
    const double trace = Contract(R, F) - 3;
    return moduli_.mu * (F - R).squaredNorm() + 0.5 * moduli_.lambda * trace * trace;
  }

  Mat3 Stress(const Mat3& F, const FibreState&) const {
    const Mat3 R = NearestRotation(F);
    return 2 * moduli_.mu * (F - R) + (moduli_.lambda * (Contract(R, F) - 3)) * R;
  }

  // dP = 2 mu (dF - dR) + lambda (R:dF) R + lambda tr(S - I) dR; with S = R^T F, E_k the cross product with axis k:
  // dR = sum_kl (R E_k) [(tr(S) I - S)^-1]_kl (R E_l : dF), from the skew part of R^T dF = R^T dR S + dS.
  Mat9 Tangent(const Mat3& F, const FibreState&) const {
    const Mat3 R = NearestRotation(F);
    const Mat3 S = R.transpose() * F;
    const double trace = S.trace();
    const Mat3 spin = trace * Mat3::Identity() - 0.5 * (S + S.transpose());
    const Mat3 spin_cofactor = Cofactor(spin);
    const Mat3 spin_inverse = spin_cofactor / DeterminantOf(spin, spin_cofactor);
    Eigen::Matrix<double, 9, 3> turned;  // column k: R E_k, with E_k x = e_k cross x
    turned << Vec3::Zero(), -R.col(2), R.col(1), R.col(2), Vec3::Zero(), -R.col(0), -R.col(1), R.col(0), Vec3::Zero();
    const Vec9 r = Flatten(R);
    Mat9 tangent = moduli_.lambda * r * r.transpose();
    tangent.diagonal().array() += 2 * moduli_.mu;
    tangent += (moduli_.lambda * (trace - 3) - 2 * moduli_.mu) * (turned * spin_inverse * turned.transpose());
    return tangent;
  }

  double ShearModulus() const { return moduli_.mu; }
  double BulkModulus() const { return moduli_.Bulk(); }
  double VolumeModulus() const { return 0; }
  CorotatedLinear WithVolumeModulus(double) const { return *this; }

 private:
  IsotropicModuli moduli_;
};
static_assert(ConstitutiveModel<CorotatedLinear>);

}  // namespace fascicle

#endif  // FASCICLE_CORE_MATERIALS_COROTATED_LINEAR_H_
