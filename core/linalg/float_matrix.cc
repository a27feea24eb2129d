#include "core/linalg/float_matrix.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace fascicle {
namespace {

// Least admissible eigenvalue of a diagonal block, relative to its largest.
constexpr double kLeastEigenvalue = 1e-6;

// Whether all eigenvalues of a symmetric block exceed that bound: by Sylvester's criterion, and because det / trace^2
// is a lower bound for the least eigenvalue.
bool IsClearlyPositive(const Mat3& block) {
  const double minor = block(0, 0) * block(1, 1) - block(1, 0) * block(1, 0);
  const double trace = block.trace();
  return block(0, 0) > 0 && minor > 0 && block.determinant() > kLeastEigenvalue * trace * trace * trace;
}

}  // namespace

Mat3 PositiveInverse(const Mat3& block) {
  if (IsClearlyPositive(block)) return block.inverse();
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(block);
  Vec3 values = eigen.eigenvalues().cwiseAbs();
  const double least = kLeastEigenvalue * values.maxCoeff();
  values = values.cwiseMax(least > 0 ? least : 1);
  return eigen.eigenvectors() * values.cwiseInverse().asDiagonal() * eigen.eigenvectors().transpose();
}

void FloatMatrix::SetValues(const BlockPattern& pattern, const BlockValues& values, ThreadTeam& team) {
  pattern_ = &pattern;
  blocks_.resize(values.size());
  inverse_diagonal_.resize(pattern.rows());
  ForNodes(team, pattern.rows(), [&](std::size_t i) {
    for (std::int32_t k = pattern.begin[i]; k < pattern.begin[i + 1]; ++k) blocks_.Set(k, values[k]);
    const auto n = static_cast<std::int32_t>(i);
    inverse_diagonal_[i] = FloatBlock(PositiveInverse(values[pattern.PlaceOf(n, n)]));
  });
}

}  // namespace fascicle
