#ifndef FASCICLE_CORE_GEOMETRY_SURFACE_DISTANCE_H_
#define FASCICLE_CORE_GEOMETRY_SURFACE_DISTANCE_H_

#include <limits>
#include <optional>
#include <vector>

#include "core/geometry/triangle_tree.h"

namespace fascicle {

// A signed distance at a point, its gradient and its second derivative.
struct SignedDistance {
  double distance = 0;            // negative inside [m]
  Vec3 normal = Vec3::UnitZ();    // its gradient: unit, outward
  Mat3 curvature = Mat3::Zero();  // its second derivative [1/m]
};

// The signed distance from a closed surface of triangles, its gradient and its second derivative. Its sign is that of
// the angle-weighted normal of the nearest face, edge or node [Baerentzen & Aanaes 2005, Signed distance computation
// using the angle weighted pseudonormal, IEEE TVCG 11]. Thread-safe.
class SurfaceDistance {
 public:
  struct Place : SignedDistance {
    Vec3 nearest = Vec3::Zero();  // the nearest point of the surface [m]
  };

  // `surface` [m] is outward, has at least one triangle, and must outlive the object unchanged.
  explicit SurfaceDistance(const TriangleMesh& surface);

  // At a point that is nearer to the surface than `within` [m], on either side; otherwise nothing. Where several points
  // of the surface are nearest, it is that of one of them, always the same.
  std::optional<Place> At(const Vec3& point, double within = std::numeric_limits<double>::infinity()) const;

 private:
  struct Edge {
    std::int32_t low, high;  // its nodes
    Vec3 normal;             // sum of those of its faces
  };
  const Vec3& NormalOfEdge(std::int32_t a, std::int32_t b) const;

  const TriangleMesh& surface_;
  TriangleTree tree_;
  std::vector<Vec3> of_faces_, of_nodes_;  // unit; weighted with angles
  std::vector<Edge> of_edges_;             // by ascending nodes
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_SURFACE_DISTANCE_H_
