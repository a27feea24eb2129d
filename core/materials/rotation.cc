#include "core/materials/rotation.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <limits>

#include "core/materials/constitutive_model.h"

namespace fascicle {

Mat3 NearestRotationBySvd(const Mat3& F) {
  if (!F.allFinite()) return Mat3::Constant(std::numeric_limits<double>::quiet_NaN());
  const Eigen::JacobiSVD<Mat3> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Mat3 U = svd.matrixU();
  // The least singular value takes the sign, so that the product is a proper rotation.
  if ((U * svd.matrixV().transpose()).determinant() < 0) U.col(2) = -U.col(2);
  return U * svd.matrixV().transpose();
}

void NearestRotationBySvd(const double* F, double* R) {
  Eigen::Map<Mat3>{R} = NearestRotationBySvd(Mat3(Eigen::Map<const Mat3>(F)));
}

Mat3 NearestRotation(const Mat3& F) { return ToEigen(NearestRotation(ToNumbers(F))); }

}  // namespace fascicle
