// Any bytes as a mesh file; the first byte selects the format. What is read must be consistent and pass through the
// checks.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/base/check.h"
#include "core/geometry/mesh_checks.h"
#include "core/geometry/mesh_io.h"

namespace fascicle {
namespace {

void CheckConsistent(const TetMesh& mesh) {
  const auto check_node = [&](std::int32_t n) {
    FASCICLE_CHECK(n >= 0 && static_cast<std::size_t>(n) < mesh.nodes.size(), "a node is out of range");
  };
  for (const Tetrahedron& tetrahedron : mesh.tetrahedra) {
    for (const std::int32_t n : tetrahedron) check_node(n);
  }
  for (const Triangle& triangle : mesh.tagged_triangles) {
    for (const std::int32_t n : triangle) check_node(n);
  }
  FASCICLE_CHECK(mesh.tetrahedron_tags.empty() || mesh.tetrahedron_tags.size() == mesh.tetrahedra.size(), "tags");
  for (const std::int32_t n : mesh.tagged_nodes) check_node(n);
  FASCICLE_CHECK(mesh.node_tags.size() == mesh.tagged_nodes.size(), "node tags");
  for (const auto& [t, tag] : mesh.further_tags) {
    FASCICLE_CHECK(t >= 0 && static_cast<std::size_t>(t) < mesh.tetrahedra.size(), "a tetrahedron is out of range");
  }
  FASCICLE_CHECK(mesh.triangle_tags.size() == mesh.tagged_triangles.size(), "triangle tags");
}

void ReadAnything(std::string_view data) {
  constexpr std::string_view kNames[] = {"m.msh", "m.vtu", "m.vtk", "m.mesh", "m.node", "m.inp"};
  if (data.empty()) return;
  MeshFile file;
  file.name = kNames[static_cast<unsigned char>(data[0]) % std::size(kNames)];
  file.bytes = data.substr(1);
  file.solids = static_cast<Solids>(data.size() % 2);
  // TetGen's two files, separated by a zero.
  if (const std::size_t cut = file.bytes.find('\0'); file.name == "m.node" && cut != std::string_view::npos) {
    file.element_bytes = file.bytes.substr(cut + 1);
    file.bytes = file.bytes.substr(0, cut);
  }
  Problems problems;
  std::optional<TetMesh> mesh = ReadMesh(file, problems);
  FASCICLE_CHECK(mesh.has_value() == problems.empty(), "a mesh or problems");
  if (!mesh) return;
  CheckConsistent(*mesh);
  OrientConsistently(*mesh);
  CheckMesh(*mesh, problems);
}

}  // namespace
}  // namespace fascicle

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fascicle::ReadAnything({reinterpret_cast<const char*>(data), size});
  return 0;
}
