#include "core/materials/spd.h"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace fascicle {

Mat9 NearestPositiveByEigenvalues(const Mat9& tangent, double floor) {
  if (!tangent.allFinite()) return tangent;
  const Eigen::SelfAdjointEigenSolver<Mat9> eigen(tangent);
  // Adds the missing part instead of reassembling the matrix: the part above the floor keeps its digits.
  Mat9 projected = tangent;
  for (int i = 0; i < 9 && eigen.eigenvalues()[i] < floor; ++i) {
    const Eigen::Matrix<double, 9, 1> v = std::sqrt(floor - eigen.eigenvalues()[i]) * eigen.eigenvectors().col(i);
    projected += v * v.transpose();
  }
  return projected;
}

}  // namespace fascicle
