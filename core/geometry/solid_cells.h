#ifndef FASCICLE_CORE_GEOMETRY_SOLID_CELLS_H_
#define FASCICLE_CORE_GEOMETRY_SOLID_CELLS_H_

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <vector>

namespace fascicle {

// Hexahedra, wedges and pyramids, and their split into tetrahedra. Nodes are in the order of Gmsh, FEBio and Abaqus:
// the base counter-clockwise seen from the rest, then the top in the same order (a hexahedron, a wedge), or the apex.
enum class SolidShape { kHexahedron, kWedge, kPyramid };

constexpr int CornersOf(SolidShape shape) {
  switch (shape) {
    case SolidShape::kHexahedron:
      return 8;
    case SolidShape::kWedge:
      return 6;
    case SolidShape::kPyramid:
      return 5;
  }
  return 0;
}

// A side by local nodes, counter-clockwise from outside; -1 in the last place of triangles.
using SolidSide = std::array<int, 4>;

namespace internal {

inline constexpr std::array<SolidSide, 6> kHexahedronSides = {
    {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}};
inline constexpr std::array<SolidSide, 5> kWedgeSides = {
    {{0, 2, 1, -1}, {3, 4, 5, -1}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}}};
inline constexpr std::array<SolidSide, 5> kPyramidSides = {
    {{0, 3, 2, 1}, {0, 1, 4, -1}, {1, 2, 4, -1}, {2, 3, 4, -1}, {3, 0, 4, -1}}};

}  // namespace internal

// The sides in the order of Abaqus (S1, S2, ...).
constexpr std::span<const SolidSide> SidesOf(SolidShape shape) {
  switch (shape) {
    case SolidShape::kHexahedron:
      return internal::kHexahedronSides;
    case SolidShape::kWedge:
      return internal::kWedgeSides;
    case SolidShape::kPyramid:
      return internal::kPyramidSides;
  }
  return {};
}

// The local nodes of a wedge and a pyramid in the hexahedron that it is with one side collapsed to an edge, or the top
// to a point. Shape functions of the hexahedron then add up to those of the shape.
inline constexpr std::array<int, 8> kWedgeAsHexahedron = {0, 1, 2, 2, 3, 4, 5, 5};
inline constexpr std::array<int, 8> kPyramidAsHexahedron = {0, 1, 2, 3, 4, 4, 4, 4};

template <class Index>
std::array<Index, 8> AsHexahedron(SolidShape shape, const std::array<Index, 8>& nodes) {
  if (shape == SolidShape::kHexahedron) return nodes;
  const auto& order = shape == SolidShape::kWedge ? kWedgeAsHexahedron : kPyramidAsHexahedron;
  std::array<Index, 8> hexahedron = {};
  for (std::size_t a = 0; a < 8; ++a) hexahedron[a] = nodes[static_cast<std::size_t>(order[a])];
  return hexahedron;
}

// A solid by its distinct nodes, in the order of its shape.
template <class Index>
struct Solid {
  SolidShape shape = SolidShape::kHexahedron;
  std::array<Index, 8> nodes = {};  // the first CornersOf(shape)

  std::span<const Index> corners() const { return {nodes.data(), static_cast<std::size_t>(CornersOf(shape))}; }
};

// A hexahedron that may be a wedge or a pyramid with repeated nodes; nothing if its nodes are repeated otherwise.
template <class Index>
std::optional<Solid<Index>> SolidOf(const std::array<Index, 8>& hexahedron) {
  for (const SolidShape shape : {SolidShape::kHexahedron, SolidShape::kWedge, SolidShape::kPyramid}) {
    Solid<Index> solid{shape, hexahedron};
    if (shape == SolidShape::kWedge) std::copy_n(hexahedron.begin() + 4, 3, solid.nodes.begin() + 3);
    if (AsHexahedron(shape, solid.nodes) != hexahedron) continue;
    std::array<Index, 8> sorted = solid.nodes;
    const auto end = sorted.begin() + CornersOf(shape);
    std::sort(sorted.begin(), end);
    if (std::adjacent_find(sorted.begin(), end) == end) return solid;
  }
  return std::nullopt;
}

// Number of tetrahedra of a solid (SplitSolid).
constexpr int TetrahedraOf(SolidShape shape) {
  return shape == SolidShape::kHexahedron ? 6 : shape == SolidShape::kWedge ? 3 : 2;
}

// A quadrilateral as two triangles, along the diagonal from its lowest node.
template <class Index>
std::array<std::array<Index, 3>, 2> SplitQuad(const std::array<Index, 4>& nodes) {
  const auto first = std::min_element(nodes.begin(), nodes.end()) - nodes.begin();
  const auto at = [&](int k) { return nodes[static_cast<std::size_t>((first + k) % 4)]; };
  return {{{at(0), at(1), at(2)}, {at(0), at(2), at(3)}}};
}

// Adds the tetrahedra of a solid: from its lowest node to the triangles of the sides that do not contain it, with sides
// split by SplitQuad. So neighbours match, and a grid is split by Kuhn's rule, as in MakeBox [Dompierre et al. 1999].
template <class Index>
void SplitSolid(SolidShape shape, std::span<const Index> nodes, std::vector<std::array<Index, 4>>& tetrahedra) {
  const Index apex = *std::min_element(nodes.begin(), nodes.end());
  for (const SolidSide& side : SidesOf(shape)) {
    std::array<Index, 4> corners = {};
    const int count = side[3] < 0 ? 3 : 4;
    bool holds_apex = false;
    for (int c = 0; c < count; ++c) {
      corners[c] = nodes[side[c]];
      holds_apex = holds_apex || corners[c] == apex;
    }
    if (holds_apex) continue;
    if (count == 3) {
      tetrahedra.push_back({apex, corners[0], corners[1], corners[2]});
      continue;
    }
    for (const auto& [a, b, c] : SplitQuad(corners)) tetrahedra.push_back({apex, a, b, c});
  }
}

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_SOLID_CELLS_H_
