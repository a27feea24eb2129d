#ifndef FASCICLE_CORE_BASE_TYPES_H_
#define FASCICLE_CORE_BASE_TYPES_H_

#include <Eigen/Core>

namespace fascicle {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
// Tangent dP/dF: row and column 3 * j + i belong to component (i, j), Eigen's column-major order of Mat3.
using Mat9 = Eigen::Matrix<double, 9, 9>;

}  // namespace fascicle

#endif  // FASCICLE_CORE_BASE_TYPES_H_
