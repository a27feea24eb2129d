#ifndef FASCICLE_CORE_GEOMETRY_FACES_H_
#define FASCICLE_CORE_GEOMETRY_FACES_H_

#include <array>
#include <cstdint>
#include <vector>

#include "core/geometry/tet_mesh.h"

namespace fascicle {

// A side of a tetrahedron, comparable with the same side of its neighbour.
struct Face {
  Triangle nodes;         // ascending
  std::int64_t side = 0;  // 4 * tetrahedron + local side
};

// The node indices in ascending order.
Triangle Ascending(Triangle triangle);

// Local side 0 to 3, counter-clockwise seen from outside of a tetrahedron of positive volume.
Triangle OutwardTriangle(const Tetrahedron& tetrahedron, int local_side);

// All sides of all tetrahedra, ordered by nodes, then by side: equal ones stand together. O(n log n).
std::vector<Face> SortedFaces(const std::vector<Tetrahedron>& tetrahedra);

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_FACES_H_
