#include "client/import/tetrahedra.h"

#include <algorithm>
#include <span>

namespace fascicle::client {

SolidShape SolidShapeOf(Shape shape) {
  if (shape == Shape::kHex8) return SolidShape::kHexahedron;
  return shape == Shape::kPenta6 ? SolidShape::kWedge : SolidShape::kPyramid;
}

std::vector<Triangle> TrianglesOf(const Facet& facet) {
  const auto& n = facet.node;
  if (facet.corners == 3) return {{n[0], n[1], n[2]}};
  const auto [first, second] = SplitQuad(n);
  return {first, second};
}

Hexahedron HexahedronOf(const Mesh& mesh, const Tetrahedra& all, std::size_t t) {
  const Part& part = mesh.parts[static_cast<std::size_t>(all.part[t])];
  Hexahedron nodes;
  std::copy_n(part.nodes.begin() + static_cast<std::ptrdiff_t>(part.count) * all.element[t], 8, nodes.begin());
  return nodes;
}

Tetrahedra MakeTetrahedra(const Mesh& mesh, bool of_hexahedra) {
  Tetrahedra all;
  all.of_hexahedra = of_hexahedra;
  for (std::size_t p = 0; p < mesh.parts.size(); ++p) {
    const Part& part = mesh.parts[p];
    if (part.material < 0) continue;
    const std::size_t count = part.count;
    for (std::size_t e = 0; e < part.size(); ++e) {
      const std::span<const std::int32_t> nodes(part.nodes.data() + e * count, count);
      std::array<std::int32_t, 6> middles;
      middles.fill(-1);
      if (part.shape == Shape::kTet4 || part.shape == Shape::kTet10) {
        all.corners.push_back({nodes[0], nodes[1], nodes[2], nodes[3]});
        if (part.shape == Shape::kTet10) std::copy(nodes.begin() + 4, nodes.end(), middles.begin());
      } else {
        SplitSolid(SolidShapeOf(part.shape), nodes, all.corners);
      }
      all.middles.resize(all.corners.size(), middles);
      all.part.resize(all.corners.size(), static_cast<std::int32_t>(p));
      all.element.resize(all.corners.size(), static_cast<std::int32_t>(e));
    }
  }
  return all;
}

}  // namespace fascicle::client
