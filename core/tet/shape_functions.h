#ifndef FASCICLE_CORE_TET_SHAPE_FUNCTIONS_H_
#define FASCICLE_CORE_TET_SHAPE_FUNCTIONS_H_

#include "core/geometry/quadratic_tetrahedron.h"

// Constants of the two elements: nodes, quadrature points and shape functions. Plain numbers, because both element.h,
// which uses Eigen, and the vectorized kernels need them. All functions are always inlined, since kernels of several
// instruction sets must share no code.
namespace fascicle {

// The edges of a tetrahedron as a plain array.
inline constexpr int kEdgeEnds[6][2] = {{kTetEdges[0][0], kTetEdges[0][1]}, {kTetEdges[1][0], kTetEdges[1][1]},
                                        {kTetEdges[2][0], kTetEdges[2][1]}, {kTetEdges[3][0], kTetEdges[3][1]},
                                        {kTetEdges[4][0], kTetEdges[4][1]}, {kTetEdges[5][0], kTetEdges[5][1]}};

// Four nodes, constant strain.
struct LinearShape {
  static constexpr int kNodes = 4;
  static constexpr int kPoints = 1;
  static constexpr double kPointWeight = 1;  // fraction of the element's volume
  // Fraction of the element's lumped mass at each node.
  static constexpr double kMassShare[kNodes] = {0.25, 0.25, 0.25, 0.25};

  // Barycentric coordinate of corner c at point q.
  [[gnu::always_inline]] static constexpr double Barycentric(int /*q*/, int /*c*/) { return 0.25; }
  // Weight of node a in corner c of the linear tetrahedron at point q; see element.h.
  [[gnu::always_inline]] static constexpr double CornerWeight(int /*q*/, int c, int a) { return c == a ? 1 : 0; }
};

// Ten nodes: the corners, then the mid-edge nodes in the order of kTetEdges. Edges may be curved at rest; the strain is
// linear if they are straight. Quadrature of degree two with four points [Zienkiewicz, Taylor & Zhu 2013, 5.11].
struct QuadraticShape {
  static constexpr int kNodes = 10;
  static constexpr int kPoints = 4;
  static constexpr double kPointWeight = 0.25;
  // The diagonal of the consistent mass matrix, V/70 and 8V/105, scaled to the element's mass. All entries are
  // positive, unlike row sums [Hinton, Rock & Zienkiewicz 1976].
  static constexpr double kMassShare[kNodes] = {1. / 36, 1. / 36, 1. / 36, 1. / 36, 4. / 27,
                                                4. / 27, 4. / 27, 4. / 27, 4. / 27, 4. / 27};

  [[gnu::always_inline]] static constexpr double Barycentric(int q, int c) { return q == c ? kNearCorner : kFarCorner; }
  [[gnu::always_inline]] static constexpr double CornerWeight(int q, int c, int a) {
    if (a < 4) return a == c ? 4 * Barycentric(q, c) - 1 : 0;
    const auto& edge = kEdgeEnds[a - 4];
    if (edge[0] == c) return 4 * Barycentric(q, edge[1]);
    return edge[1] == c ? 4 * Barycentric(q, edge[0]) : 0;
  }
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_SHAPE_FUNCTIONS_H_
