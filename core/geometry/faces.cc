#include "core/geometry/faces.h"

#include <algorithm>
#include <numeric>
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

namespace {

// Calls use(face) for all faces, by sides.
template <class Use>
void ForEachFace(const std::vector<Tetrahedron>& tetrahedra, const Use& use) {
  for (std::size_t t = 0; t < tetrahedra.size(); ++t) {
    for (int side = 0; side < 4; ++side) {
      use(Face{Ascending(OutwardTriangle(tetrahedra[t], side)), static_cast<std::int64_t>(4 * t + side)});
    }
  }
}

}  // namespace

std::vector<Face> SortedFaces(const std::vector<Tetrahedron>& tetrahedra, const std::stop_token& stop) {
  if (tetrahedra.empty()) return {};
  std::int64_t lowest = tetrahedra[0][0], highest = lowest;
  for (const Tetrahedron& tetrahedron : tetrahedra) {
    for (const std::int32_t n : tetrahedron) {
      lowest = std::min<std::int64_t>(lowest, n);
      highest = std::max<std::int64_t>(highest, n);
    }
  }
  // Faces with the same lowest node have the same place, unless the nodes are so few that places would be too many.
  const std::int64_t most_places = 4 * static_cast<std::int64_t>(tetrahedra.size());
  const std::int64_t width = (highest - lowest) / most_places + 1;
  const auto place_of = [&](const Face& face) { return static_cast<std::size_t>((face.nodes[0] - lowest) / width); };
  std::vector<std::size_t> ends((highest - lowest) / width + 2);
  ForEachFace(tetrahedra, [&](const Face& face) { ++ends[place_of(face) + 1]; });
  std::partial_sum(ends.begin(), ends.end(), ends.begin());
  std::vector<Face> faces(4 * tetrahedra.size());
  ForEachFace(tetrahedra, [&](const Face& face) { faces[ends[place_of(face)]++] = face; });
  // Now each entry is the end of its place. What a place has is few, except in a star.
  ThrowIfStopped(stop);
  std::size_t begin = 0;
  for (const std::size_t end : ends) {
    std::sort(faces.begin() + static_cast<std::ptrdiff_t>(begin), faces.begin() + static_cast<std::ptrdiff_t>(end),
              [&stop](const Face& a, const Face& b) {
                ThrowIfStopped(stop);
                return std::tie(a.nodes, a.side) < std::tie(b.nodes, b.side);
              });
    begin = end;
  }
  return faces;
}

}  // namespace fascicle
