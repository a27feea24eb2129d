#ifndef FASCICLE_CORE_MATERIALS_ROTATION_H_
#define FASCICLE_CORE_MATERIALS_ROTATION_H_

#include <cmath>

#include "core/materials/tensor_algebra.h"

namespace fascicle {

// The rotation nearest to F, det R = +1, by singular values; also for det F <= 0. NaN where F is not finite.
Mat3 NearestRotationBySvd(const Mat3& F);

// The rotation nearest to F (its polar factor where det F > 0): R maximizes tr(R^T F) over the rotations.
// Newton's iteration with Frobenius scaling for what is safely invertible, singular values for the rest.
// [Higham 1986, Computing the polar decomposition - with applications, SIAM J. Sci. Stat. Comput. 7]
inline Mat3 NearestRotation(const Mat3& F) {
  constexpr double kSafelyInvertible = 1e-6;  // least J relative to |F|^3
  constexpr double kConverged = 1e-18;        // squared change; convergence is quadratic, so the next one is nil
  constexpr int kMaxIterations = 20;          // six are usual
  Mat3 R = F;
  Mat3 cofactor = Cofactor(R);
  double J = DeterminantOf(R, cofactor);
  const double size = R.squaredNorm();
  if (!(J > kSafelyInvertible * size * std::sqrt(size))) return NearestRotationBySvd(F);
  for (int i = 0; i < kMaxIterations; ++i) {
    const double scale = std::sqrt(std::sqrt(cofactor.squaredNorm() / R.squaredNorm()) / J);
    const Mat3 next = (0.5 * scale) * R + (0.5 / (scale * J)) * cofactor;
    const double change = (next - R).squaredNorm();
    R = next;
    if (change <= kConverged) return R;
    cofactor = Cofactor(R);
    J = DeterminantOf(R, cofactor);
  }
  return NearestRotationBySvd(F);
}

}  // namespace fascicle

#endif  // FASCICLE_CORE_MATERIALS_ROTATION_H_
