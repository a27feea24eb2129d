#include "client/import/tetrahedra.h"

#include <algorithm>
#include <span>

namespace fascicle::client {
namespace {

// Sides by local nodes, counter-clockwise from outside; -1 in the last place of triangles.
using Side = std::array<int, 4>;
constexpr std::array<Side, 6> kHexSides = {
    {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}};
constexpr std::array<Side, 5> kPentaSides = {{{0, 2, 1, -1}, {3, 4, 5, -1}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}}};
constexpr std::array<Side, 5> kPyraSides = {{{0, 3, 2, 1}, {0, 1, 4, -1}, {1, 2, 4, -1}, {2, 3, 4, -1}, {3, 0, 4, -1}}};

std::span<const Side> SidesOf(Shape shape) {
  if (shape == Shape::kHex8) return kHexSides;
  if (shape == Shape::kPenta6) return kPentaSides;
  return kPyraSides;
}

// Splits an element: a tetrahedron from the first node to each triangle of the sides that do not contain it.
void Split(Shape shape, std::span<const std::int32_t> nodes, std::vector<Tetrahedron>& tetrahedra) {
  const std::int32_t apex = *std::min_element(nodes.begin(), nodes.end());
  for (const Side& side : SidesOf(shape)) {
    Facet facet;
    facet.corners = side[3] < 0 ? 3 : 4;
    bool holds_apex = false;
    for (int c = 0; c < facet.corners; ++c) {
      facet.node[c] = nodes[side[c]];
      holds_apex = holds_apex || facet.node[c] == apex;
    }
    if (holds_apex) continue;
    for (const auto& [a, b, c] : TrianglesOf(facet)) tetrahedra.push_back({apex, a, b, c});
  }
}

}  // namespace

std::vector<Triangle> TrianglesOf(const Facet& facet) {
  const auto& n = facet.node;
  if (facet.corners == 3) return {{n[0], n[1], n[2]}};
  const int f = static_cast<int>(std::min_element(n.begin(), n.end()) - n.begin());
  const auto at = [&](int k) { return n[(f + k) % 4]; };
  return {{at(0), at(1), at(2)}, {at(0), at(2), at(3)}};
}

Tetrahedra MakeTetrahedra(const Mesh& mesh) {
  Tetrahedra all;
  for (std::size_t p = 0; p < mesh.parts.size(); ++p) {
    const Part& part = mesh.parts[p];
    if (part.material < 0) continue;
    const auto count = static_cast<std::size_t>(NodesOf(part.shape));
    for (std::size_t e = 0; e < part.size(); ++e) {
      const std::span<const std::int32_t> nodes(part.nodes.data() + e * count, count);
      std::array<std::int32_t, 6> middles;
      middles.fill(-1);
      if (part.shape == Shape::kTet4 || part.shape == Shape::kTet10) {
        all.corners.push_back({nodes[0], nodes[1], nodes[2], nodes[3]});
        if (part.shape == Shape::kTet10) std::copy(nodes.begin() + 4, nodes.end(), middles.begin());
      } else {
        Split(part.shape, nodes, all.corners);
      }
      all.middles.resize(all.corners.size(), middles);
      all.part.resize(all.corners.size(), static_cast<std::int32_t>(p));
      all.element.resize(all.corners.size(), static_cast<std::int32_t>(e));
    }
  }
  return all;
}

}  // namespace fascicle::client
