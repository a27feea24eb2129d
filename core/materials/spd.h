#ifndef FASCICLE_CORE_MATERIALS_SPD_H_
#define FASCICLE_CORE_MATERIALS_SPD_H_

#include <Eigen/Cholesky>

#include "core/base/types.h"

namespace fascicle {

// Like NearestPositive below, by eigenvalues for every matrix.
Mat9 NearestPositiveByEigenvalues(const Mat9& tangent, double floor);

// The matrix nearest to a symmetric one, in the Frobenius norm, that has no eigenvalue below `floor` >= 0: lower
// eigenvalues are raised to it. With a tangent projected like this, Newton's method has a direction of descent. A
// matrix that already qualifies, by a Cholesky factorization, is returned unchanged; so is one that is not finite.
// [Higham 1988, Computing a nearest symmetric positive semidefinite matrix, Linear Algebra Appl. 103]
inline Mat9 NearestPositive(const Mat9& tangent, double floor = 0) {
  Mat9 raised = tangent;
  raised.diagonal().array() -= floor;
  if (Eigen::LLT<Mat9>(raised).info() == Eigen::Success) return tangent;
  return NearestPositiveByEigenvalues(tangent, floor);
}

}  // namespace fascicle

#endif  // FASCICLE_CORE_MATERIALS_SPD_H_
