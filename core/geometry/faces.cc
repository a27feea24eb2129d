#include "core/geometry/faces.h"

#include <algorithm>
#include <tuple>

#include "core/base/stop.h"

namespace fascicle {

Triangle Ascending(Triangle triangle) {
  std::sort(triangle.begin(), triangle.end());
  return triangle;
}

Triangle OutwardTriangle(const Tetrahedron& tetrahedron, int local_side) {
  static constexpr int kSides[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  const auto& side = kSides[local_side];
  return {tetrahedron[side[0]], tetrahedron[side[1]], tetrahedron[side[2]]};
}

std::vector<Face> SortedFaces(const std::vector<Tetrahedron>& tetrahedra, const std::stop_token& stop) {
  std::vector<Face> faces;
  faces.reserve(4 * tetrahedra.size());
  for (std::size_t t = 0; t < tetrahedra.size(); ++t) {
    for (int side = 0; side < 4; ++side) {
      faces.push_back({Ascending(OutwardTriangle(tetrahedra[t], side)), static_cast<std::int64_t>(4 * t + side)});
    }
  }
  SortUnlessStopped(faces, stop,
                    [](const Face& a, const Face& b) { return std::tie(a.nodes, a.side) < std::tie(b.nodes, b.side); });
  return faces;
}

}  // namespace fascicle
