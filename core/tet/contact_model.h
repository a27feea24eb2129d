#ifndef FASCICLE_CORE_TET_CONTACT_MODEL_H_
#define FASCICLE_CORE_TET_CONTACT_MODEL_H_

#include <array>
#include <cstdint>
#include <vector>

#include "core/geometry/obstacle.h"
#include "core/tet/position_loads.h"

namespace fascicle {

// A face around a point, and its part of the point's stiffness. It counts as far as it faces what the point touches:
// at an edge of a body, the faces beside the one that touches carry nothing.
struct SurfaceSide {
  std::array<std::int32_t, 4> corners = {};  // of a triangle: the last one twice
  double stiffness = 0;                      // [N/m]
};

// A point of a body's surface, at a fixed place of a face: the sum of weights times positions of nodes.
struct SurfacePoint {
  std::array<std::int32_t, 9> nodes = {};
  std::array<double, 9> weights = {};
  int count = 0;
  double stiffness = 0;         // of its contact, at most [N/m]
  std::int32_t first_side = 0;  // of its sides in ContactModel::sides
  std::int32_t sides = 0;
  // A tenth of the shortest edge of its faces: contact keeps the depth below it [m].
  double allowed_depth = 0;

  template <class Positions>
  Vec3 PositionIn(const Positions& x) const {
    Vec3 sum = weights[0] * x[nodes[0]];
    for (int a = 1; a < count; ++a) sum += weights[a] * x[nodes[a]];
    return sum;
  }
};

// What touches in a scene, and what stays constant of it.
//
// Points are those of a quadrature rule on the faces that contains all nodes and has positive weights, so that a
// constant pressure gives its consistent nodal forces: corners of linear triangles and rectangles; corners, mid-edge
// nodes and the centroid of quadratic triangles (weights 1/20, 2/15, 9/20); the nine nodes of biquadratic sides
// (Simpson's). The stiffness per area is that of a layer of half an element: c M / (l/2), where l is the edge of a
// right triangle or square of the face's area. Explicit and mixed steppings: c = 1 and M the longitudinal modulus, so
// that contact hardly reduces the stable step. Others: c = 10, and M that of the law if Poisson's ratio were at most
// 0.4, because bodies yield to contact by shear.
struct ContactModel {
  std::vector<SurfacePoint> points;            // that may touch rigid bodies
  std::vector<std::size_t> point_begin = {0};  // those of body b: points[point_begin[b] .. point_begin[b + 1])
  std::vector<ObstacleDistance> rigid;         // of each of Scene::rigid_bodies
  std::vector<SurfaceSide> sides;

  bool empty() const { return rigid.empty(); }
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_CONTACT_MODEL_H_
