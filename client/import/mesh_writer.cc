// Gmsh MSH 2.2, ASCII [Gmsh reference manual, "Gmsh mesh file formats"].
#include "client/import/mesh_writer.h"

#include <charconv>

namespace fascicle::client {
namespace {

constexpr int kTriangle3 = 2, kTetrahedron4 = 4, kHexahedron8 = 5, kTetrahedron10 = 11, kPoint = 15;

class Lines {
 public:
  Lines& operator<<(const char* text) {
    text_ += text;
    return *this;
  }
  Lines& operator<<(const std::string& text) {
    text_ += text;
    return *this;
  }
  template <class Number>
  Lines& operator<<(Number number) {
    char buffer[32];
    text_.append(buffer, std::to_chars(buffer, buffer + sizeof(buffer), number).ptr);  // shortest that reads back
    return *this;
  }
  std::string text_;
};

void WriteElement(std::size_t& number, int type, std::int32_t tag, const auto& nodes, Lines& out) {
  out << ++number << " " << type << " 2 " << tag << " " << tag;
  for (const std::int32_t n : nodes) out << " " << n + 1;
  out << "\n";
}

void WriteElements(const MeshToWrite& mesh, Lines& out) {
  std::size_t count = mesh.tetrahedra.size() + mesh.hexahedra.size(), number = 0;
  for (const TaggedPart& part : mesh.parts) count += part.nodes.size() + part.triangles.size();
  out << "$Elements\n" << count << "\n";
  for (const TaggedPart& part : mesh.parts) {
    for (const std::int32_t n : part.nodes) WriteElement(number, kPoint, part.tag, std::array{n}, out);
    for (const Triangle& triangle : part.triangles) WriteElement(number, kTriangle3, part.tag, triangle, out);
  }
  for (std::size_t h = 0; h < mesh.hexahedra.size(); ++h) {
    WriteElement(number, kHexahedron8, mesh.tags[h], mesh.hexahedra[h], out);
  }
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    if (mesh.middles.empty()) {
      WriteElement(number, kTetrahedron4, mesh.tags[t], mesh.tetrahedra[t], out);
      continue;
    }
    const auto& c = mesh.tetrahedra[t];
    const auto& m = mesh.middles[t];
    // Gmsh has edge 2-3 before edge 1-3.
    WriteElement(number, kTetrahedron10, mesh.tags[t],
                 std::array{c[0], c[1], c[2], c[3], m[0], m[1], m[2], m[3], m[5], m[4]}, out);
  }
  out << "$EndElements\n";
}

}  // namespace

std::string GmshText(const MeshToWrite& mesh) {
  Lines out;
  out << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
  out << "$PhysicalNames\n" << mesh.parts.size() << "\n";
  for (const TaggedPart& part : mesh.parts) {
    out << part.dimension << " " << part.tag << " \"" << part.name << "\"\n";
  }
  out << "$EndPhysicalNames\n$Nodes\n" << mesh.nodes.size() << "\n";
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    const Vec3& x = mesh.nodes[n];
    out << n + 1 << " " << x[0] << " " << x[1] << " " << x[2] << "\n";
  }
  out << "$EndNodes\n";
  WriteElements(mesh, out);
  return std::move(out.text_);
}

}  // namespace fascicle::client
