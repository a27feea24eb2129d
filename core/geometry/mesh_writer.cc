// [Gmsh reference manual, "MSH file format version 2"]
#include "core/geometry/mesh_writer.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <concepts>
#include <map>

#include "core/base/stop.h"
#include "core/geometry/gmsh_types.h"
#include "core/geometry/hexahedron.h"
#include "core/geometry/quadratic_hexahedron.h"
#include "core/geometry/solid_cells.h"

namespace fascicle {
namespace {

// Numbers are written in the shortest form that reads back exactly.
template <class Number>
void Append(Number value, std::string& text) {
  std::array<char, 32> digits;
  const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  text.append(digits.data(), end);
}

template <std::integral... Numbers>
void AppendLine(std::string& text, Numbers... numbers) {
  ((Append(numbers, text), text += ' '), ...);
  text.back() = '\n';
}

// The nodes of all edges when some are curved, numbered after the nodes of the mesh.
class MidEdgeNodes {
 public:
  explicit MidEdgeNodes(const TetMesh& mesh) : first_(static_cast<std::int32_t>(mesh.nodes.size())) {
    if (mesh.curved_edges.empty()) return;
    std::map<Ends, Vec3> curved;
    for (const CurvedEdge& edge : mesh.curved_edges) curved[EndsOf(edge.ends[0], edge.ends[1])] = edge.middle;
    const auto add = [&](std::int32_t i, std::int32_t j) {
      const Ends ends = EndsOf(i, j);
      const auto next = first_ + static_cast<std::int32_t>(positions_.size());
      if (!numbers_.try_emplace(ends, next).second) return;
      const auto found = curved.find(ends);
      positions_.push_back(found != curved.end() ? found->second
                                                 : Vec3(0.5 * (mesh.nodes[ends[0]] + mesh.nodes[ends[1]])));
    };
    for (const Hexahedron& h : mesh.hexahedra) {
      for (const auto& [i, j] : kHexEdges) add(h[i], h[j]);
    }
    if (!mesh.hexahedra.empty()) return;
    for (const Tetrahedron& t : mesh.tetrahedra) {
      for (const auto& [i, j] : kTetEdges) add(t[i], t[j]);
    }
  }

  const std::vector<Vec3>& positions() const { return positions_; }
  std::int32_t Between(std::int32_t i, std::int32_t j) const { return numbers_.at(EndsOf(i, j)); }

 private:
  using Ends = std::array<std::int32_t, 2>;
  static Ends EndsOf(std::int32_t i, std::int32_t j) { return {std::min(i, j), std::max(i, j)}; }

  std::int32_t first_;
  std::map<Ends, std::int32_t> numbers_;
  std::vector<Vec3> positions_;
};

void AppendNode(std::size_t number, const Vec3& position, std::string& text) {
  Append(number, text);
  for (const double x : position) {
    text += ' ';
    Append(x, text);
  }
  text += '\n';
}

void AppendTetrahedron(std::size_t number, const Tetrahedron& t, std::int32_t tag, const MidEdgeNodes& middles,
                       std::string& text) {
  const auto& [a, b, c, d] = t;
  if (middles.positions().empty()) {
    AppendLine(text, number, gmsh::kTetrahedron4, 2, tag, tag, a + 1, b + 1, c + 1, d + 1);
    return;
  }
  const auto middle = [&](std::int32_t i, std::int32_t j) { return middles.Between(i, j) + 1; };
  AppendLine(text, number, gmsh::kTetrahedron10, 2, tag, tag, a + 1, b + 1, c + 1, d + 1, middle(a, b), middle(b, c),
             middle(a, c), middle(a, d), middle(c, d), middle(b, d));
}

// A hexahedron, a wedge or a pyramid; with mid-edge nodes if there are any.
void AppendHexahedron(std::size_t number, const Hexahedron& hexahedron, std::int32_t tag, const MidEdgeNodes& middles,
                      std::string& text) {
  const Solid<std::int32_t> solid =
      SolidOf(hexahedron).value_or(Solid<std::int32_t>{SolidShape::kHexahedron, hexahedron});
  std::vector<std::int32_t> nodes(solid.corners().begin(), solid.corners().end());
  std::int64_t type = solid.shape == SolidShape::kHexahedron ? gmsh::kHexahedron8
                      : solid.shape == SolidShape::kWedge    ? gmsh::kWedge6
                                                             : gmsh::kPyramid5;
  if (!middles.positions().empty()) {
    type = gmsh::kHexahedron20;
    for (const auto& [i, j] : gmsh::kHexahedronEdges) nodes.push_back(middles.Between(hexahedron[i], hexahedron[j]));
  }
  for (const auto head :
       {static_cast<std::int64_t>(number), type, std::int64_t{2}, std::int64_t{tag}, std::int64_t{tag}}) {
    Append(head, text);
    text += ' ';
  }
  for (const std::int32_t n : nodes) {
    Append(n + 1, text);
    text += ' ';
  }
  text.back() = '\n';
}

}  // namespace

std::string GmshText(const TetMesh& mesh, const std::vector<TagName>& names, const std::stop_token& stop) {
  std::string text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
  if (!names.empty()) {
    text += "$PhysicalNames\n" + std::to_string(names.size()) + "\n";
    for (const TagName& name : names) {
      text += std::to_string(name.dimension) + " " + std::to_string(name.tag) + " \"" + name.name + "\"\n";
    }
    text += "$EndPhysicalNames\n";
  }
  const MidEdgeNodes middles(mesh);
  text += "$Nodes\n" + std::to_string(mesh.nodes.size() + middles.positions().size()) + "\n";
  std::size_t number = 0;
  for (const Vec3& node : mesh.nodes) {
    ThrowIfStopped(stop);
    AppendNode(++number, node, text);
  }
  for (const Vec3& node : middles.positions()) AppendNode(++number, node, text);
  // Tags are those of tetrahedra, also of hexahedra: of the first of each.
  const std::vector<std::size_t> first = FirstTetrahedra(mesh);
  std::vector<std::array<std::int32_t, 2>> further = mesh.further_tags;
  if (!mesh.hexahedra.empty()) {
    const std::vector<std::int32_t> hexahedra = HexahedraOfTetrahedra(mesh);
    std::erase_if(further, [&](const auto& tag) {
      const auto t = static_cast<std::size_t>(tag[0]);
      return first[static_cast<std::size_t>(hexahedra[t])] != t;
    });
    for (auto& [t, tag] : further) t = hexahedra[static_cast<std::size_t>(t)];
  }
  text +=
      "$EndNodes\n$Elements\n" +
      std::to_string(mesh.tagged_nodes.size() + mesh.tagged_triangles.size() + ElementCount(mesh) + further.size()) +
      "\n";
  // Number, type, number of tags, the tags (physical, elementary), nodes.
  number = 0;
  for (std::size_t i = 0; i < mesh.tagged_nodes.size(); ++i) {
    AppendLine(text, ++number, gmsh::kPoint, 2, mesh.node_tags[i], mesh.node_tags[i], mesh.tagged_nodes[i] + 1);
  }
  for (std::size_t i = 0; i < mesh.tagged_triangles.size(); ++i) {
    const std::int32_t tag = mesh.triangle_tags[i];
    const auto& [a, b, c] = mesh.tagged_triangles[i];
    AppendLine(text, ++number, gmsh::kTriangle3, 2, tag, tag, a + 1, b + 1, c + 1);
  }
  const auto append = [&](std::size_t e, std::int32_t tag) {
    if (mesh.hexahedra.empty()) {
      AppendTetrahedron(++number, mesh.tetrahedra[e], tag, middles, text);
    } else {
      AppendHexahedron(++number, mesh.hexahedra[e], tag, middles, text);
    }
  };
  for (std::size_t e = 0; e < ElementCount(mesh); ++e) {
    ThrowIfStopped(stop);
    append(e, mesh.tetrahedron_tags.empty() ? 0 : mesh.tetrahedron_tags[mesh.hexahedra.empty() ? e : first[e]]);
  }
  for (const auto& [e, tag] : further) append(static_cast<std::size_t>(e), tag);
  return text + "$EndElements\n";
}

}  // namespace fascicle
