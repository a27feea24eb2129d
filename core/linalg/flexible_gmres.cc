#include "core/linalg/flexible_gmres.h"

#include <Eigen/Eigenvalues>

namespace fascicle {

double LeastRealPart(const Eigen::MatrixXd& matrix) {
  return Eigen::EigenSolver<Eigen::MatrixXd>(matrix, false).eigenvalues().real().minCoeff();
}

}  // namespace fascicle
