#ifndef FASCICLE_CORE_TET_ELEMENT_H_
#define FASCICLE_CORE_TET_ELEMENT_H_

#include <Eigen/Geometry>

#include <array>
#include <cstdint>

#include "core/geometry/hexahedron.h"
#include "core/geometry/quadratic_hexahedron.h"
#include "core/geometry/tet_mesh.h"
#include "core/linalg/nodal_vector.h"
#include "core/tet/shape_functions.h"

// Shape functions and geometry of one element [Teran 2003, 3 and 4].
//
// All elements reduce to linear tetrahedra: a quadrature point of the quadratic element behaves like a linear
// tetrahedron whose corners are fixed combinations of the element's ten nodes, because
//   F = sum_a x_a (x) grad N_a = sum_c y_c (x) g_c,   y_c = (4 L_c - 1) x_c + sum_{j != c} 4 L_j x_cj,
// with L the barycentric coordinates of the point, g_c their rest gradients in that tetrahedron, and x_cj the mid-edge
// node between c and j. A point of a hexahedron behaves like one with y_0 = 0 and y_c = sum_a x_a dN_a/dxi_c. So all
// laws and loops are written for a linear tetrahedron.
namespace fascicle {

// Values at the corners of one such tetrahedron.
using CornerValues = std::array<Vec3, 4>;

struct LinearElement : LinearShape {
  // Positions (or other values) of the corners of the linear tetrahedron at point q.
  static const CornerValues& Corners(const std::array<Vec3, 4>& nodes, int /*q*/) { return nodes; }
  // Adds the transpose of Corners: forces on the corners become forces on the nodes.
  static void AddCorners(const CornerValues& corners, int /*q*/, std::array<Vec3, 4>& nodes) {
    for (int c = 0; c < 4; ++c) nodes[c] += corners[c];
  }
};

struct QuadraticElement : QuadraticShape {
  static CornerValues Corners(const std::array<Vec3, 10>& nodes, int q) {
    return CornersAt(nodes, {Barycentric(q, 0), Barycentric(q, 1), Barycentric(q, 2), Barycentric(q, 3)});
  }
  static void AddCorners(const CornerValues& corners, int q, std::array<Vec3, 10>& nodes) {
    for (int c = 0; c < 4; ++c) nodes[c] += (4 * Barycentric(q, c) - 1) * corners[c];
    for (int k = 0; k < 6; ++k) {
      const auto [i, j] = kTetEdges[k];
      nodes[4 + k] += 4 * Barycentric(q, j) * corners[i] + 4 * Barycentric(q, i) * corners[j];
    }
  }
};

template <class Shape>
struct CubeElement : Shape {
  static CornerValues Corners(const std::array<Vec3, Shape::kNodes>& nodes, int q) {
    CornerValues corners;
    corners.fill(Vec3::Zero());
    for (int a = 0; a < Shape::kNodes; ++a) {
      for (int d = 0; d < 3; ++d) corners[1 + d] += Shape::Slope(q, a, d) * nodes[a];
    }
    return corners;
  }
  static void AddCorners(const CornerValues& corners, int q, std::array<Vec3, Shape::kNodes>& nodes) {
    for (int a = 0; a < Shape::kNodes; ++a) {
      for (int d = 0; d < 3; ++d) nodes[a] += Shape::Slope(q, a, d) * corners[1 + d];
    }
  }
};
using HexahedralElement = CubeElement<HexahedralShape>;
using HexahedralQuadraticElement = CubeElement<HexahedralQuadraticShape>;

// The corners between which a higher node of an element lies: the two of its edge, the four of its side, or all of a
// hexahedron. Straight at rest, it is in their middle.
struct Parents {
  int count = 0;
  std::array<int, 8> corners = {};
};
template <class Element>
constexpr Parents ParentsOf(int a) {
  Parents parents;
  const auto add = [&](int corner) { parents.corners[parents.count++] = corner; };
  if constexpr (Element::kNodes == 10) {
    for (const int corner : kTetEdges[a - 4]) add(corner);
  } else if constexpr (Element::kNodes == 27) {
    if (a < 20) {
      for (const int corner : kHexEdges[a - 8]) add(corner);
    } else if (a < 26) {
      for (const int corner : kHexSides[a - 20]) add(corner);
    } else {
      for (int corner = 0; corner < 8; ++corner) add(corner);
    }
  }
  return parents;
}

// [a1 - a0, a2 - a0, a3 - a0] of values a at the corners: Dm for rest positions, Ds for positions, the rate of Ds for
// velocities.
inline Mat3 EdgeMatrix(const NodalVector& values, const Tetrahedron& corners) {
  const Vec3& origin = values[corners[0]];
  Mat3 edges;
  edges.col(0) = values[corners[1]] - origin;
  edges.col(1) = values[corners[2]] - origin;
  edges.col(2) = values[corners[3]] - origin;
  return edges;
}

inline Mat3 EdgeMatrix(const CornerValues& corners) {
  Mat3 edges;
  for (int c = 0; c < 3; ++c) edges.col(c) = corners[c + 1] - corners[0];
  return edges;
}

// The edges of the whole element as a parallelepiped, from values at its nodes: those at the corner of a tetrahedron,
// the mean ones of a hexahedron.
template <std::size_t kNodes>
Mat3 MeanEdges(const std::array<Vec3, kNodes>& nodes) {
  if constexpr (kNodes == 8) {
    return TrilinearSlopes(nodes, Vec3::Constant(0.5));
  } else if constexpr (kNodes == 27) {
    return TriquadraticSlopes(nodes, Vec3::Constant(0.5));
  } else {
    return EdgeMatrix(CornerValues{nodes[0], nodes[1], nodes[2], nodes[3]});
  }
}

inline double Determinant(const Mat3& F) { return F.col(0).dot(F.col(1).cross(F.col(2))); }

// Second Piola-Kirchhoff viscous stress S_v = 2 mu Edot + lambda tr(Edot) I, Edot = sym(F^T Fdot). It vanishes in rigid
// motions, and S_v : Edot >= 0.
struct ViscousStress {
  ViscousStress(const Mat3& F, const Mat3& F_rate, double mu, double lambda) {
    const Mat3 product = F.transpose() * F_rate;
    const Mat3 rate = 0.5 * (product + product.transpose());
    const double trace = rate.trace();
    S = 2 * mu * rate;
    S.diagonal().array() += lambda * trace;
    power = 2 * mu * rate.squaredNorm() + lambda * trace * trace;
  }

  Mat3 S;        // [Pa]
  double power;  // dissipation, S_v : Edot [W/m^3]
};

// [f1 f2 f3] = P Bm3 = -V P Dm^-T, f0 = -(f1 + f2 + f3) [Teran 2003, 4.1].
inline void SetCornerForces(const Mat3& P, const Mat3& Dm_inverse, double volume, CornerValues& forces) {
  const Mat3 f = (-volume * P) * Dm_inverse.transpose();
  forces[1] = f.col(0);
  forces[2] = f.col(1);
  forces[3] = f.col(2);
  forces[0] = -(forces[1] + forces[2] + forces[3]);
}

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_ELEMENT_H_
