#ifndef FASCICLE_CORE_TET_SHAPE_FUNCTIONS_H_
#define FASCICLE_CORE_TET_SHAPE_FUNCTIONS_H_

#include "core/geometry/hexahedron.h"
#include "core/geometry/quadratic_hexahedron.h"
#include "core/geometry/quadratic_tetrahedron.h"

// Constants of the elements: nodes, quadrature points and shape functions. Plain numbers, because both element.h, which
// uses Eigen, and the vectorized kernels need them. All functions are always inlined, since kernels of several
// instruction sets must share no code.
//   kCorners     nodes of the mesh; the others, up to kNodes, are made by the model (TetModel::ForHigherNodes)
//   PointWeight  fraction of the volume of the reference element
//   kPatches     patches of an element (volume_patches.h). Those of tetrahedra belong to their corners, those of
//                hexahedra to the element
//   PatchWeight  the weight of the c-th of them at point q
namespace fascicle {

// The edges of a tetrahedron as a plain array.
inline constexpr int kEdgeEnds[6][2] = {{kTetEdges[0][0], kTetEdges[0][1]}, {kTetEdges[1][0], kTetEdges[1][1]},
                                        {kTetEdges[2][0], kTetEdges[2][1]}, {kTetEdges[3][0], kTetEdges[3][1]},
                                        {kTetEdges[4][0], kTetEdges[4][1]}, {kTetEdges[5][0], kTetEdges[5][1]}};

// Four nodes, constant strain.
struct LinearShape {
  static constexpr int kNodes = 4, kCorners = 4, kPoints = 1;
  static constexpr bool kIsHexahedron = false;
  [[gnu::always_inline]] static constexpr double PointWeight(int /*q*/) { return 1; }
  // Fraction of the element's lumped mass at each node.
  static constexpr double kMassShare[kNodes] = {0.25, 0.25, 0.25, 0.25};

  // Barycentric coordinate of corner c at point q.
  [[gnu::always_inline]] static constexpr double Barycentric(int /*q*/, int /*c*/) { return 0.25; }
  static constexpr int kPatches = 4;
  [[gnu::always_inline]] static constexpr double PatchWeight(int q, int c) { return Barycentric(q, c); }
  // Weight of node a in corner c of the linear tetrahedron at point q; see element.h.
  [[gnu::always_inline]] static constexpr double CornerWeight(int /*q*/, int c, int a) { return c == a ? 1 : 0; }
};

// Ten nodes: the corners, then the mid-edge nodes in the order of kTetEdges. Edges may be curved at rest; the strain is
// linear if they are straight. Quadrature of degree two with four points [Zienkiewicz, Taylor & Zhu 2013, 5.11].
struct QuadraticShape {
  static constexpr int kNodes = 10, kCorners = 4, kPoints = 4;
  static constexpr bool kIsHexahedron = false;
  [[gnu::always_inline]] static constexpr double PointWeight(int /*q*/) { return 0.25; }
  // The diagonal of the consistent mass matrix, V/70 and 8V/105, scaled to the element's mass. All entries are
  // positive, unlike row sums [Hinton, Rock & Zienkiewicz 1976].
  static constexpr double kMassShare[kNodes] = {1. / 36, 1. / 36, 1. / 36, 1. / 36, 4. / 27,
                                                4. / 27, 4. / 27, 4. / 27, 4. / 27, 4. / 27};

  [[gnu::always_inline]] static constexpr double Barycentric(int q, int c) { return q == c ? kNearCorner : kFarCorner; }
  static constexpr int kPatches = 4;
  [[gnu::always_inline]] static constexpr double PatchWeight(int q, int c) { return Barycentric(q, c); }
  [[gnu::always_inline]] static constexpr double CornerWeight(int q, int c, int a) {
    if (a < 4) return a == c ? 4 * Barycentric(q, c) - 1 : 0;
    const auto& edge = kEdgeEnds[a - 4];
    if (edge[0] == c) return 4 * Barycentric(q, edge[1]);
    return edge[1] == c ? 4 * Barycentric(q, edge[0]) : 0;
  }
};

// Eight nodes in the order of VTK: counter-clockwise around the lower side, then around the upper one. Trilinear, with
// 2 x 2 x 2 Gauss points. The dilatation is that of the whole element: one patch (mean dilatation [Simo, Taylor &
// Pister 1985], Q1/P0).
//
// The reference cube is scaled to the volume of the reference tetrahedron, 1/6, so that det E / 6 is a volume for all
// elements, with E = sum_a x_a (x) dN_a/dxi in place of a tetrahedron's edges. In the notation of element.h, corner 0
// of the linear tetrahedron is the origin, and corner c the c-th column of E.
struct HexahedralShape {
  static constexpr int kNodes = 8, kCorners = 8, kPoints = 8;
  static constexpr bool kIsHexahedron = true;
  [[gnu::always_inline]] static constexpr double PointWeight(int /*q*/) { return 0.125; }
  static constexpr int kPatches = 1;
  [[gnu::always_inline]] static constexpr double PatchWeight(int /*q*/, int /*c*/) { return 1; }

  // The coordinates of point q, from 0 to 1 along each axis.
  [[gnu::always_inline]] static constexpr double Place(int q, int d) { return (q >> d & 1) != 0 ? 1 - kNear : kNear; }
  // The factor of a node at coordinate x along an axis.
  [[gnu::always_inline]] static constexpr double Factor(bool is_far, double x) { return is_far ? x : 1 - x; }
  // The shape function of node a at point q.
  [[gnu::always_inline]] static constexpr double Value(int q, int a) {
    return Factor(IsFarNode(a, 0), Place(q, 0)) * Factor(IsFarNode(a, 1), Place(q, 1)) *
           Factor(IsFarNode(a, 2), Place(q, 2));
  }
  // Its derivative along axis d of the scaled cube.
  [[gnu::always_inline]] static constexpr double Slope(int q, int a, int d) {
    const int e = (d + 1) % 3, f = (d + 2) % 3;
    return (IsFarNode(a, d) ? kScale : -kScale) * Factor(IsFarNode(a, e), Place(q, e)) *
           Factor(IsFarNode(a, f), Place(q, f));
  }
  [[gnu::always_inline]] static constexpr double CornerWeight(int q, int c, int a) {
    return c == 0 ? 0 : Slope(q, a, c - 1);
  }

  static constexpr double kNear = 0.21132486540518711775;  // (1 - 1/sqrt(3)) / 2
  static constexpr double kScale = 1.8171205928321396589;  // cbrt(6): inverse edge of the scaled cube
};

// Twenty-seven nodes: the corners, then those of kHexEdges and kHexSides, then the centre. Triquadratic, with 3 x 3 x 3
// Gauss points, on the same scaled cube. The dilatation is a linear function of the element's coordinates, without
// continuity (Q2/P1), which is inf-sup stable [Boffi & Gastaldi 2002, On the quadrilateral Q2-P1 element for the Stokes
// problem]. Its four patches have the weights L_c of LinearPart. These are orthogonal, so that theta_c = (integral of
// L_c J) / (integral of L_c) are the values of the projection of J on the linear functions at the points where one L_c
// is 1 and the others are 0; exactly where the element is a parallelepiped.
struct HexahedralQuadraticShape {
  static constexpr int kNodes = 27, kCorners = 8, kPoints = 27;
  static constexpr bool kIsHexahedron = true;
  [[gnu::always_inline]] static constexpr double PointWeight(int q) {
    return LineWeight(q % 3) * LineWeight(q / 3 % 3) * LineWeight(q / 9);
  }
  static constexpr int kPatches = 4;
  [[gnu::always_inline]] static constexpr double PatchWeight(int q, int c) {
    return LinearPart(c, Place(q, 0), Place(q, 1), Place(q, 2));
  }

  [[gnu::always_inline]] static constexpr double LineWeight(int i) { return i == 1 ? 4. / 9 : 5. / 18; }
  // The coordinates of point q, from 0 to 1 along each axis.
  [[gnu::always_inline]] static constexpr double Place(int q, int d) {
    const int i = d == 0 ? q % 3 : d == 1 ? q / 3 % 3 : q / 9;
    return i == 0 ? kNear : i == 1 ? 0.5 : 1 - kNear;
  }
  // The shape function of node a at point q, and its derivative along axis d of the scaled cube.
  [[gnu::always_inline]] static constexpr double Value(int q, int a) {
    return QuadraticFactor(HexNodeStep(a, 0), Place(q, 0)) * QuadraticFactor(HexNodeStep(a, 1), Place(q, 1)) *
           QuadraticFactor(HexNodeStep(a, 2), Place(q, 2));
  }
  [[gnu::always_inline]] static constexpr double Slope(int q, int a, int d) {
    const int e = (d + 1) % 3, f = (d + 2) % 3;
    return HexahedralShape::kScale * QuadraticFactorSlope(HexNodeStep(a, d), Place(q, d)) *
           QuadraticFactor(HexNodeStep(a, e), Place(q, e)) * QuadraticFactor(HexNodeStep(a, f), Place(q, f));
  }
  [[gnu::always_inline]] static constexpr double CornerWeight(int q, int c, int a) {
    return c == 0 ? 0 : Slope(q, a, c - 1);
  }

  static constexpr double kNear = 0.11270166537925831148;  // (1 - sqrt(3/5)) / 2
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_SHAPE_FUNCTIONS_H_
