// [Gmsh reference manual, "MSH file format version 2"]
#include "core/geometry/mesh_writer.h"

#include <array>
#include <charconv>
#include <concepts>

#include "core/base/stop.h"

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
  text += "$Nodes\n" + std::to_string(mesh.nodes.size()) + "\n";
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    ThrowIfStopped(stop);
    Append(n + 1, text);
    for (const double x : mesh.nodes[n]) {
      text += ' ';
      Append(x, text);
    }
    text += '\n';
  }
  text += "$EndNodes\n$Elements\n" + std::to_string(mesh.tagged_triangles.size() + mesh.tetrahedra.size()) + "\n";
  // Number, type, number of tags, the tags (physical, elementary), nodes.
  std::size_t number = 0;
  for (std::size_t i = 0; i < mesh.tagged_triangles.size(); ++i) {
    const std::int32_t tag = mesh.triangle_tags[i];
    const auto& [a, b, c] = mesh.tagged_triangles[i];
    AppendLine(text, ++number, 2, 2, tag, tag, a + 1, b + 1, c + 1);
  }
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    ThrowIfStopped(stop);
    const std::int32_t tag = mesh.tetrahedron_tags.empty() ? 0 : mesh.tetrahedron_tags[t];
    const auto& [a, b, c, d] = mesh.tetrahedra[t];
    AppendLine(text, ++number, 4, 2, tag, tag, a + 1, b + 1, c + 1, d + 1);
  }
  return text + "$EndElements\n";
}

}  // namespace fascicle
