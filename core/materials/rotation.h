#ifndef FASCICLE_CORE_MATERIALS_ROTATION_H_
#define FASCICLE_CORE_MATERIALS_ROTATION_H_

#include "core/base/matrix3.h"
#include "core/base/numbers.h"
#include "core/base/types.h"

namespace fascicle {

// The rotation nearest to F, det R = +1, by singular value decomposition; also for det F <= 0. NaN where F is not
// finite.
Mat3 NearestRotationBySvd(const Mat3& F);
// The same for nine numbers in column-major order.
void NearestRotationBySvd(const double* F, double* R);

// For one number and for Lanes: sets R to the rotation by singular value decomposition where `todo` is true.
inline void TakeRotationBySvd(bool todo, const Matrix3<double>& F, Matrix3<double>& R) {
  if (todo) NearestRotationBySvd(F.m, R.m);
}
template <class T>
void TakeRotationBySvd(const typename T::Mask& todo, const Matrix3<T>& F, Matrix3<T>& R) {
  for (int lane = 0; lane < T::kLanes; ++lane) {
    if (!todo[lane]) continue;
    double f[9], r[9];
    for (int k = 0; k < 9; ++k) f[k] = F.m[k][lane];
    NearestRotationBySvd(f, r);
    for (int k = 0; k < 9; ++k) R.m[k].v[lane] = static_cast<typename T::Scalar>(r[k]);
  }
}
inline bool AnyOf(bool condition) { return condition; }
template <class Mask>
bool AnyOf(const Mask& mask) {
  return mask.Any();
}

// The rotation nearest to F (the polar factor where det F > 0): R maximizes tr(R^T F) over all rotations. Newton's
// iteration with Frobenius scaling where F is well-conditioned, singular value decomposition elsewhere.
// [Higham 1986, Computing the polar decomposition - with applications, SIAM J. Sci. Stat. Comput. 7]
template <class T>
Matrix3<T> NearestRotation(const Matrix3<T>& F) {
  constexpr double kSafelyInvertible = 1e-6;  // least J relative to |F|^3
  constexpr double kConverged = 1e-18;        // squared change; the next one is below round-off (quadratic convergence)
  constexpr int kMaxIterations = 20;          // six are usual
  Matrix3<T> R = F;
  const T size = SquaredNorm(F);
  const auto safe = Determinant(F) > kSafelyInvertible * size * Sqrt(size);
  auto todo = safe;
  for (int i = 0; i < kMaxIterations && AnyOf(todo); ++i) {
    const Matrix3<T> cofactor = Cofactor(R);
    const T J = DeterminantOf(R, cofactor);
    const T scale = Sqrt(Sqrt(SquaredNorm(cofactor) / SquaredNorm(R)) / J);
    const Matrix3<T> next = (0.5 * scale) * R + (0.5 / (scale * J)) * cofactor;
    const auto converged = SquaredNorm(next - R) <= kConverged;
    for (int k = 0; k < 9; ++k) R.m[k] = Select(todo, next.m[k], R.m[k]);
    todo = todo & !converged;
  }
  const decltype(todo) left = todo | !safe;
  if (AnyOf(left)) TakeRotationBySvd(left, F, R);
  return R;
}
Mat3 NearestRotation(const Mat3& F);

}  // namespace fascicle

#endif  // FASCICLE_CORE_MATERIALS_ROTATION_H_
