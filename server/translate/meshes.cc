#include "server/translate/meshes.h"

#include <algorithm>
#include <array>
#include <utility>

#include "core/geometry/mesh_checks.h"
#include "core/geometry/mesh_io.h"
#include "core/geometry/unused_nodes.h"
#include "server/translate/built_in_shapes.h"
#include "server/translate/images.h"
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

bool Spend(std::int64_t count, const char* what, std::int64_t& budget, const std::string& path, const char* hint,
           Problems& problems) {
  if (count > budget) {
    problems.Add(path,
                 std::to_string(count) + " " + what + " are too many; " + std::to_string(budget) + " are left for it",
                 hint);
    return false;
  }
  budget -= count;
  return true;
}

VoxelGrid BoxOfVoxels(const v1::BoxShape& shape, double metres) {
  const GridIndex size = {shape.divisions(0), shape.divisions(1), shape.divisions(2)};
  const Vec3 spacing = (ToVec3(shape.size()) * metres).cwiseQuotient(Vec3(size[0], size[1], size[2]));
  VoxelGrid grid = MakeVoxelGrid(size, spacing);
  grid.origin = ToVec3(shape.origin()) * metres;
  std::fill(grid.material.begin(), grid.material.end(), std::uint8_t{1});
  return grid;
}

std::optional<TranslatedMesh> TranslateVoxels(const v1::Body& body, const std::string& path, const AssetReader& assets,
                                              std::int64_t& budget, std::vector<std::string>& notes,
                                              Problems& problems) {
  const v1::Mesh& mesh = body.mesh();
  const double metres = MetresIn(body.unit());
  std::optional<VoxelGrid> grid;
  std::string source_path;
  if (mesh.has_image()) {
    source_path = JoinPath(path, "image");
    grid = TranslateImage(mesh.image(), metres, source_path, assets, notes, problems);
  } else if (mesh.has_box()) {
    source_path = JoinPath(path, "box");
    if (!ObeysRules(mesh.box())) return std::nullopt;
    std::int64_t count = 1;
    for (const std::int32_t divisions : mesh.box().divisions()) count *= divisions;
    if (!Spend(count, "voxels", budget, source_path, "take fewer divisions", problems)) return std::nullopt;
    grid = BoxOfVoxels(mesh.box(), metres);
  } else {
    problems.Add(path, "the voxel method takes an image or a box",
                 "voxels of an image: image; tetrahedra need the tet method");
  }
  if (!grid) return std::nullopt;
  TranslatedMesh result;
  result.bricks = MakeBrickMesh(std::move(*grid));
  if (mesh.has_image() && !Spend(static_cast<std::int64_t>(result.bricks.bricks.size()), "voxels", budget, source_path,
                                 "take a higher level, or a smaller region", problems)) {
    return std::nullopt;
  }
  return result;
}

std::optional<TranslatedMesh> TranslateTetrahedra(const v1::Body& body, const std::string& body_path,
                                                  const AssetReader& assets, std::int64_t& budget, Problems& problems) {
  const std::string path = JoinPath(body_path, "mesh");
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
    if (!Spend(static_cast<std::int64_t>(read->tetrahedra.size()), "tetrahedra", budget, source_path,
               "take a coarser mesh", problems)) {
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
    if (!Spend(shape->tetrahedra, "tetrahedra", budget, source_path, "take fewer divisions", problems))
      return std::nullopt;
    result.mesh = MakeShape(body.mesh(), metres);
  }
  Problems own;
  CheckMesh(result.mesh, own);
  problems.Append(source_path, own);
  result.sound = own.empty();
  if (!IsAddressable(result.mesh)) return std::nullopt;
  return result;
}

// The boundary of tetrahedra, with the nodes that it has.
TriangleMesh BoundaryOf(const TetMesh& mesh) {
  TriangleMesh surface = {mesh.nodes, BoundaryTriangles(mesh)};
  DropUnusedNodes(surface.nodes, surface.triangles);
  return surface;
}

std::optional<TranslatedMesh> TranslateSurface(const v1::Body& body, const std::string& body_path,
                                               const AssetReader& assets, std::int64_t& budget, Problems& problems) {
  const std::string path = JoinPath(body_path, "mesh");
  if (!body.mesh().has_surface()) {
    auto result = TranslateTetrahedra(body, body_path, assets, budget, problems);
    if (result) result->surface = BoundaryOf(result->mesh);
    return result;
  }
  const std::string file_path = JoinPath(path, "surface");
  if (body.unit() == v1::LENGTH_UNIT_UNSPECIFIED) {
    problems.Add(JoinPath(body_path, "unit"), "is missing: a surface file does not say its unit", "mm, cm or m");
  }
  CheckElements(body.mesh(), path, problems);
  const v1::FileRef& file = body.mesh().surface();
  const auto bytes = ReadFile(file, file_path, assets, problems);
  if (!bytes || file.path().empty()) return std::nullopt;
  Problems own;
  auto read = ReadSurface(file.path(), *bytes, own);
  problems.Append(file_path, own);
  if (!read) return std::nullopt;
  if (!Spend(static_cast<std::int64_t>(read->triangles.size()), "triangles", budget, file_path,
             "take a coarser surface", problems)) {
    return std::nullopt;
  }
  // Of an unknown size, it would be said to be too large for its grid, or too small.
  if (body.unit() == v1::LENGTH_UNIT_UNSPECIFIED) return std::nullopt;
  TranslatedMesh result;
  result.surface = std::move(*read);
  for (Vec3& x : result.surface.nodes) x *= MetresIn(body.unit());
  return result;
}

const char* MethodName(Method method) {
  return method == Method::kVoxel ? "voxel" : method == Method::kEulerian ? "eulerian" : "tet";
}

}  // namespace

std::string SourcePath(const v1::Mesh& mesh, const std::string& body_path) {
  const auto* field =
      mesh.GetReflection()->GetOneofFieldDescriptor(mesh, v1::Mesh::descriptor()->FindOneofByName("source"));
  const std::string path = JoinPath(body_path, "mesh");
  return field == nullptr ? path : JoinPath(path, field->name());
}

std::optional<TranslatedMesh> TranslateMesh(const v1::Body& body, Method method, const std::string& body_path,
                                            const AssetReader& assets, std::int64_t& budget,
                                            std::vector<std::string>& notes, Problems& problems) {
  const std::string path = JoinPath(body_path, "mesh");
  if (!body.has_mesh()) {
    problems.Add(path, "is missing",
                 method == Method::kVoxel      ? "give one of: image, box"
                 : method == Method::kEulerian ? "give one of: surface, file, box, fusiform, torus, sphere"
                                               : "give one of: file, box, fusiform, torus, sphere");
    return std::nullopt;
  }
  // A mesh without a source is reported with the rules.
  if (body.mesh().source_case() == v1::Mesh::SOURCE_NOT_SET) return std::nullopt;
  if (method == Method::kVoxel) return TranslateVoxels(body, path, assets, budget, notes, problems);
  if (body.mesh().has_image()) {
    problems.Add(
        JoinPath(path, "image"), std::string("the ") + MethodName(method) + " method takes no image",
        "`fascicle mesh` fills the labels of an image with tetrahedra, `fascicle segment` makes labels; or use "
        "the voxel method");
    return std::nullopt;
  }
  if (method == Method::kEulerian) return TranslateSurface(body, body_path, assets, budget, problems);
  if (body.mesh().has_surface()) {
    problems.Add(JoinPath(path, "surface"), "the tet method needs tetrahedra",
                 "`fascicle mesh` fills a closed surface with them; or use the eulerian method");
    return std::nullopt;
  }
  return TranslateTetrahedra(body, body_path, assets, budget, problems);
}

}  // namespace fascicle::server
