#include "server/translate/meshes.h"

#include <algorithm>
#include <array>

#include "core/geometry/mesh_checks.h"
#include "core/geometry/mesh_io.h"
#include "server/translate/built_in_shapes.h"
#include "server/translate/values.h"

namespace fascicle::server {
namespace {

bool IsTetGen(const v1::FileRef& file) { return file.path().ends_with(".node") || file.path().ends_with(".NODE"); }

void CheckElements(const v1::Mesh& mesh, const std::string& path, Problems& problems) {
  const bool wanted = mesh.has_file() && IsTetGen(mesh.file());
  if (wanted && !mesh.has_elements()) {
    problems.Add(JoinPath(path, "elements"), "is missing", "the .ele file of " + mesh.file().path());
  } else if (!wanted && mesh.has_elements()) {
    problems.Add(JoinPath(path, "elements"), "is given, but the mesh is no TetGen .node file", "leave it out");
  }
}

std::optional<TetMesh> ReadMeshFile(const v1::Mesh& mesh, const std::string& path, const AssetReader& assets,
                                    Problems& problems) {
  CheckElements(mesh, path, problems);
  const std::string file_path = JoinPath(path, "file");
  const auto bytes = ReadFile(mesh.file(), file_path, assets, problems);
  std::optional<std::string> element_bytes;
  if (IsTetGen(mesh.file())) {
    if (!mesh.has_elements()) return std::nullopt;
    element_bytes = ReadFile(mesh.elements(), JoinPath(path, "elements"), assets, problems);
    if (!element_bytes) return std::nullopt;
  }
  if (!bytes || mesh.file().path().empty()) return std::nullopt;
  Problems own;
  auto read = ReadMesh({mesh.file().path(), *bytes, element_bytes ? *element_bytes : std::string_view()}, own);
  problems.Append(file_path, own);
  return read;
}

// What region selection and the boundary rely on. CheckMesh names the culprits.
bool IsAddressable(const TetMesh& mesh) {
  const auto count = static_cast<std::int64_t>(mesh.nodes.size());
  const auto in_range = [count](const auto& cell) {
    return std::all_of(cell.begin(), cell.end(), [count](std::int32_t node) { return node >= 0 && node < count; });
  };
  return !mesh.tetrahedra.empty() && std::all_of(mesh.tetrahedra.begin(), mesh.tetrahedra.end(), in_range) &&
         std::all_of(mesh.tagged_triangles.begin(), mesh.tagged_triangles.end(), in_range) &&
         in_range(mesh.tagged_nodes) &&
         std::all_of(mesh.nodes.begin(), mesh.nodes.end(), [](const Vec3& x) { return x.allFinite(); });
}

bool Spend(std::int64_t count, std::int64_t& budget, const std::string& path, const char* hint, Problems& problems) {
  if (count > budget) {
    problems.Add(
        path, std::to_string(count) + " tetrahedra are too many; " + std::to_string(budget) + " are left for it", hint);
    return false;
  }
  budget -= count;
  return true;
}

}  // namespace

std::optional<TranslatedMesh> TranslateMesh(const v1::Body& body, const std::string& body_path,
                                            const AssetReader& assets, std::int64_t& budget, Problems& problems) {
  const std::string path = JoinPath(body_path, "mesh");
  if (!body.has_mesh()) {
    problems.Add(path, "is missing", "give one of: file, box, fusiform, torus, sphere");
    return std::nullopt;
  }
  TranslatedMesh result;
  std::string source_path;
  const double metres = MetresIn(body.unit());
  if (body.mesh().has_file()) {
    source_path = JoinPath(path, "file");
    if (body.unit() == v1::LENGTH_UNIT_UNSPECIFIED) {
      problems.Add(JoinPath(body_path, "unit"), "is missing: a mesh file does not say its unit", "mm, cm or m");
    }
    auto read = ReadMeshFile(body.mesh(), path, assets, problems);
    if (!read) return std::nullopt;
    if (!Spend(static_cast<std::int64_t>(read->tetrahedra.size()), budget, source_path, "take a coarser mesh",
               problems)) {
      return std::nullopt;
    }
    result.mesh = std::move(*read);
    for (Vec3& x : result.mesh.nodes) x *= metres;
    for (CurvedEdge& edge : result.mesh.curved_edges) edge.middle *= metres;
    OrientConsistently(result.mesh);
  } else {
    CheckElements(body.mesh(), path, problems);
    const auto shape = CheckShape(body.mesh(), path, problems);
    if (!shape) return std::nullopt;
    source_path = shape->path;
    if (!Spend(shape->tetrahedra, budget, source_path, "take fewer divisions", problems)) return std::nullopt;
    result.mesh = MakeShape(body.mesh(), metres);
  }
  Problems own;
  CheckMesh(result.mesh, own);
  problems.Append(source_path, own);
  result.sound = own.empty();
  if (!IsAddressable(result.mesh)) return std::nullopt;
  return result;
}

}  // namespace fascicle::server
