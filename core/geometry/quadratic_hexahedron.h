#ifndef FASCICLE_CORE_GEOMETRY_QUADRATIC_HEXAHEDRON_H_
#define FASCICLE_CORE_GEOMETRY_QUADRATIC_HEXAHEDRON_H_

#include <array>

#include "core/base/types.h"
#include "core/geometry/hexahedron.h"

// Hexahedra of twenty-seven nodes in the order of VTK: the corners, a node on each edge in the order of kHexEdges, one
// on each side in that of kHexSides, and the centre. Triquadratic in coordinates from 0 to 1 along each axis.
namespace fascicle {

inline constexpr int kHexEdges[12][2] = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6},
                                         {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};
inline constexpr int kHexSides[6][4] = {{0, 3, 7, 4}, {1, 2, 6, 5}, {0, 1, 5, 4},
                                        {3, 2, 6, 7}, {0, 1, 2, 3}, {4, 5, 6, 7}};

// Where node a is along axis d: 0 at the near end, 1 in the middle, 2 at the far end.
[[gnu::always_inline]] constexpr int HexNodeStep(int a, int d) {
  const auto far = [d](int corner) {
    return d == 0 ? ((corner ^ corner >> 1) & 1) : d == 1 ? corner >> 1 & 1 : corner >> 2;
  };
  if (a < 8) return 2 * far(a);
  if (a < 20) return far(kHexEdges[a - 8][0]) + far(kHexEdges[a - 8][1]);
  if (a < 26) return (far(kHexSides[a - 20][0]) + far(kHexSides[a - 20][2]));
  return 1;
}

// The factor of a node at coordinate x along an axis, and its derivative.
[[gnu::always_inline]] constexpr double QuadraticFactor(int step, double x) {
  return step == 0 ? (1 - x) * (1 - 2 * x) : step == 1 ? 4 * x * (1 - x) : x * (2 * x - 1);
}
[[gnu::always_inline]] constexpr double QuadraticFactorSlope(int step, double x) {
  return step == 0 ? 4 * x - 3 : step == 1 ? 4 - 8 * x : 4 * x - 1;
}

// The c-th of four linear functions (1 + sqrt(3) s . t_c) / 4 of s = 2 x - 1, for t_c = (1, 1, 1), (1, -1, -1),
// (-1, 1, -1), (-1, -1, 1): 1 at the point t_c / sqrt(3), 0 at the other three, and orthogonal on the cube.
[[gnu::always_inline]] constexpr double LinearPart(int c, double x, double y, double z) {
  constexpr double kRoot3 = 1.7320508075688772935;
  const double along_x = c < 2 ? 2 * x - 1 : 1 - 2 * x;
  const double along_y = c % 2 == 0 ? 2 * y - 1 : 1 - 2 * y;
  const double along_z = c == 0 || c == 3 ? 2 * z - 1 : 1 - 2 * z;
  return 0.25 * (1 + kRoot3 * (along_x + along_y + along_z));
}

using QuadraticHexahedronNodes = std::array<Vec3, 27>;

// The value at coordinates x of values at the nodes, and its derivatives by the coordinates, one column each.
Vec3 TriquadraticValue(const QuadraticHexahedronNodes& values, const Vec3& x);
Mat3 TriquadraticSlopes(const QuadraticHexahedronNodes& values, const Vec3& x);

// Sets nodes 20 to 26, of the sides and the centre, from those of the corners and edges, by transfinite interpolation
// [Gordon & Hall 1973]: the shape of the serendipity element of twenty nodes, and trilinear where edges are straight.
void FillSidesAndCentre(QuadraticHexahedronNodes& nodes);

// Whether the Jacobian is positive at 3 x 3 x 3 Gauss points and the integral of every LinearPart is positive, so that
// the element can be used.
bool IsUsable(const QuadraticHexahedronNodes& nodes);

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_QUADRATIC_HEXAHEDRON_H_
