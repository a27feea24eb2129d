#ifndef FASCICLE_CORE_GEOMETRY_QUADRATIC_TETRAHEDRON_H_
#define FASCICLE_CORE_GEOMETRY_QUADRATIC_TETRAHEDRON_H_

#include <array>

#include "core/geometry/tet_mesh.h"

// Tetrahedra of ten nodes: the corners, then the mid-edge nodes in the order of kTetEdges.
namespace fascicle {

// Quadrature rule of degree two: at each of four points, the barycentric coordinate of the nearest corner and that of
// the other corners [Zienkiewicz, Taylor & Zhu 2013, 5.11].
inline constexpr double kNearCorner = 0.58541019662496845446;  // (5 + 3 sqrt 5) / 20
inline constexpr double kFarCorner = 0.13819660112501051518;   // (5 - sqrt 5) / 20

// Corners of the linear tetrahedron with the same Jacobian as the element at barycentric coordinates L:
//   y_c = (4 L_c - 1) x_c + sum_{j != c} 4 L_j x_cj.
inline std::array<Vec3, 4> CornersAt(const std::array<Vec3, 10>& x, const std::array<double, 4>& L) {
  std::array<Vec3, 4> corners;
  for (int c = 0; c < 4; ++c) corners[c] = (4 * L[c] - 1) * x[c];
  for (int k = 0; k < 6; ++k) {
    const auto [i, j] = kTetEdges[k];
    corners[i] += 4 * L[j] * x[4 + k];
    corners[j] += 4 * L[i] * x[4 + k];
  }
  return corners;
}

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_QUADRATIC_TETRAHEDRON_H_
