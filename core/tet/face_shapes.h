#ifndef FASCICLE_CORE_TET_FACE_SHAPES_H_
#define FASCICLE_CORE_TET_FACE_SHAPES_H_

#include <array>

#include "core/scene/method.h"
#include "core/tet/shape_functions.h"

namespace fascicle {

// Shape functions of a face and their derivatives at a place (u, v): of a triangle 0 <= u, 0 <= v, u + v <= 1, or of
// the unit square. Nodes in the order of PressureFace.
template <int kNodes>
struct FaceShape {
  std::array<double, kNodes> N, d1, d2;
};

inline FaceShape<3> LinearFace(double u, double v) { return {{1 - u - v, u, v}, {-1, 1, 0}, {-1, 0, 1}}; }

inline FaceShape<6> QuadraticFace(double u, double v) {
  const double w = 1 - u - v;
  return {{w * (2 * w - 1), u * (2 * u - 1), v * (2 * v - 1), 4 * w * u, 4 * u * v, 4 * v * w},
          {1 - 4 * w, 4 * u - 1, 0, 4 * (w - u), 4 * v, -4 * v},
          {1 - 4 * w, 0, 4 * v - 1, -4 * u, 4 * u, 4 * (w - v)}};
}

inline FaceShape<4> BilinearFace(double u, double v) {
  return {{(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v}, {v - 1, 1 - v, v, -v}, {u - 1, -u, u, 1 - u}};
}

inline FaceShape<9> BiquadraticFace(double u, double v) {
  // The step of each node along u and v: corners, edges, middle.
  constexpr int kSteps[9][2] = {{0, 0}, {2, 0}, {2, 2}, {0, 2}, {1, 0}, {2, 1}, {1, 2}, {0, 1}, {1, 1}};
  FaceShape<9> shape;
  for (int a = 0; a < 9; ++a) {
    const auto [i, j] = kSteps[a];
    shape.N[a] = QuadraticFactor(i, u) * QuadraticFactor(j, v);
    shape.d1[a] = QuadraticFactorSlope(i, u) * QuadraticFactor(j, v);
    shape.d2[a] = QuadraticFactor(i, u) * QuadraticFactorSlope(j, v);
  }
  return shape;
}

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_FACE_SHAPES_H_
