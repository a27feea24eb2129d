#ifndef FASCICLE_CORE_GEOMETRY_FACES_H_
#define FASCICLE_CORE_GEOMETRY_FACES_H_

#include <array>
#include <cstdint>
#include <stop_token>
#include <vector>

#include "core/geometry/tet_mesh.h"

namespace fascicle {

// A face of a tetrahedron, in a form that compares equal to the neighbour's copy of the same face.
struct Face {
  Triangle nodes;         // ascending
  std::int64_t side = 0;  // 4 * tetrahedron + local side
};

// The node indices in ascending order.
Triangle Ascending(Triangle triangle);

// Local side 0 to 3, counter-clockwise seen from outside of a tetrahedron of positive volume.
Triangle OutwardTriangle(const Tetrahedron& tetrahedron, int local_side);

// All faces of all tetrahedra, ordered by nodes, then by side: equal faces are adjacent. O(n log n). Throws Stopped
// after a stop request.
std::vector<Face> SortedFaces(const std::vector<Tetrahedron>& tetrahedra, const std::stop_token& stop = {});

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_FACES_H_
