#ifndef FASCICLE_CORE_MATERIALS_SPD_H_
#define FASCICLE_CORE_MATERIALS_SPD_H_

#include <Eigen/Cholesky>

#include "core/base/types.h"

namespace fascicle {

// As NearestPositive below, by eigenvalues, whatever the matrix.
Mat9 NearestPositiveByEigenvalues(const Mat9& tangent, double floor);

// The matrix nearest to a symmetric one, in the Frobenius norm, without an eigenvalue below `floor` >= 0: lower ones
// are raised to it. A tangent projected so gives Newton's method a direction of descent. One that is there already, as
// a Cholesky factorization tells, is returned as it is; so is one that is not finite. [Higham 1988, Computing a nearest
// symmetric positive semidefinite matrix, Linear Algebra Appl. 103]
inline Mat9 NearestPositive(const Mat9& tangent, double floor = 0) {
  Mat9 raised = tangent;
  raised.diagonal().array() -= floor;
  if (Eigen::LLT<Mat9>(raised).info() == Eigen::Success) return tangent;
  return NearestPositiveByEigenvalues(tangent, floor);
}

}  // namespace fascicle

#endif  // FASCICLE_CORE_MATERIALS_SPD_H_
