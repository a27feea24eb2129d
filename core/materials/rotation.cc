#include "core/materials/rotation.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <limits>

namespace fascicle {

Mat3 NearestRotationBySvd(const Mat3& F) {
  if (!F.allFinite()) return Mat3::Constant(std::numeric_limits<double>::quiet_NaN());
  const Eigen::JacobiSVD<Mat3> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Mat3 U = svd.matrixU();
  // The least singular value takes the sign, so that the product is a rotation.
  if ((U * svd.matrixV().transpose()).determinant() < 0) U.col(2) = -U.col(2);
  return U * svd.matrixV().transpose();
}

}  // namespace fascicle
