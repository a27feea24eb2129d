#ifndef FASCICLE_CORE_MATERIALS_LINEAR_ELASTIC_H_
#define FASCICLE_CORE_MATERIALS_LINEAR_ELASTIC_H_

#include <span>

#include "core/materials/isotropic_moduli.h"
#include "core/materials/tangent_terms.h"

namespace fascicle {

// W = mu e:e + lambda/2 (tr e)^2 with the small strain e = (F + F^T)/2 - I. Not objective, since rotations cause
// strain: for verification and small deflections only.
class LinearElastic : public LawFunctions<LinearElastic> {
 public:
  static constexpr const char* kName = "linear_elastic";
  static constexpr const char* kTitle = "Linear elastic (small strain)";
  static constexpr const char* kSource = "Hooke's law; Sifakis 2012, FEM Simulation of 3D Deformable Solids, 3.2";
  static constexpr auto kParameters = IsotropicModuli::kParameters;
  static constexpr bool kNeedsFibres = false;
  static constexpr bool kStiffens = false;

  explicit LinearElastic(std::span<const double> values) : moduli_(values) {}

  template <class T>
  T EnergyAt(const Matrix3<T>& F, const Fibre<T>&) const {
    const Matrix3<T> e = Strain(F);
    const T trace = Trace(e);
    return moduli_.mu * SquaredNorm(e) + 0.5 * moduli_.lambda * trace * trace;
  }

  template <class T>
  Matrix3<T> StressAt(const Matrix3<T>& F, const Fibre<T>&) const {
    const Matrix3<T> e = Strain(F);
    return PlusDiagonal(2 * moduli_.mu * e, moduli_.lambda * Trace(e));
  }

  template <class T, class Terms>
  void AddTangentAt(const Matrix3<T>&, const Fibre<T>&, Terms& terms) const {
    const Matrix3<T> identity = Diagonal(T(1.0));
    terms.Diagonal(moduli_.mu);
    terms.Transposed(moduli_.mu, identity);
    terms.Square(moduli_.lambda, identity);
  }

  double ShearModulus() const { return moduli_.mu; }
  double BulkModulus() const { return moduli_.Bulk(); }
  double VolumeModulus() const { return 0; }
  LinearElastic WithVolumeModulus(double) const { return *this; }

 private:
  template <class T>
  static Matrix3<T> Strain(const Matrix3<T>& F) {
    return PlusDiagonal(SymmetricPart(F), -1);
  }

  IsotropicModuli moduli_;
};
static_assert(ConstitutiveModel<LinearElastic>);

}  // namespace fascicle

#endif  // FASCICLE_CORE_MATERIALS_LINEAR_ELASTIC_H_
