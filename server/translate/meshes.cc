#include "server/translate/meshes.h"

#include <algorithm>
#include <array>
#include <utility>

#include "core/geometry/mesh_checks.h"
#include "core/geometry/mesh_io.h"
#include "core/geometry/text_scanner.h"
#include "server/translate/built_in_shapes.h"
#include "server/translate/files.h"
#include "server/translate/images.h"
#include "server/translate/values.h"

namespace fascicle::server {
namespace {

bool IsTetGen(const v1::FileRef& file) {
  constexpr std::string_view kExtension = ".node";
  const std::string_view path = file.path();
  return path.size() >= kExtension.size() && SameInAnyCase(path.substr(path.size() - kExtension.size()), kExtension);
}

void CheckElements(const v1::Mesh& mesh, const std::string& path, Problems& problems) {
  const bool wanted = mesh.has_file() && IsTetGen(mesh.file());
  if (wanted && !mesh.has_elements()) {
    problems.Add(JoinPath(path, "elements"), "is missing", "the .ele file of " + mesh.file().path());
  } else if (!wanted && mesh.has_elements()) {
    problems.Add(JoinPath(path, "elements"), "is given, but the mesh is not a TetGen .node file", "omit it");
  }
}

void AddNotes(const std::vector<std::string>& found, const std::string& path, std::vector<std::string>& notes) {
  for (const std::string& note : found) notes.push_back(path + ": " + note);
}

std::optional<TetMesh> ReadMeshFile(const BodySource& source, const std::string& path, MeshRemarks& remarks,
                                    std::vector<std::string>& notes, Problems& problems) {
  const v1::Mesh& mesh = source.wire.mesh();
  CheckElements(mesh, path, problems);
  const std::string file_path = JoinPath(path, "file");
  const auto bytes = ReadFile(mesh.file(), file_path, source.assets, problems);
  std::optional<std::string> element_bytes;
  if (IsTetGen(mesh.file())) {
    if (!mesh.has_elements()) return std::nullopt;
    element_bytes = ReadFile(mesh.elements(), JoinPath(path, "elements"), source.assets, problems);
    if (!element_bytes) return std::nullopt;
  }
  if (!bytes || mesh.file().path().empty()) return std::nullopt;
  Problems own;
  const MeshFile file = {.name = mesh.file().path(),
                         .bytes = *bytes,
                         .element_bytes = element_bytes ? *element_bytes : std::string_view(),
                         .solids = source.cells == Cells::kHexahedra ? Solids::kKeep : Solids::kSplit};
  auto read = ReadMesh(file, own, source.tools.stop, &remarks);
  AddNotes(remarks.notes, file_path, notes);
  problems.Append(file_path, own);
  return read;
}

// Whether regions and the boundary can be found. CheckMesh reports the causes.
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

// Whether the mesh has a source. A body without a mesh is a problem here; the rules report a mesh without a source.
//   choices  the possible sources, for the message
bool NamesSource(const BodySource& source, const char* choices, Problems& problems) {
  if (source.wire.has_mesh()) return source.wire.mesh().source_case() != v1::Mesh::SOURCE_NOT_SET;
  problems.Add(JoinPath(source.path, "mesh"), "is missing", std::string("give one of: ") + choices);
  return false;
}

void CheckUnit(const BodySource& source, const char* kind, Problems& problems) {
  if (source.wire.unit() != v1::LENGTH_UNIT_UNSPECIFIED) return;
  problems.Add(JoinPath(source.path, "unit"), std::string("is missing: a ") + kind + " file does not say its unit",
               "mm, cm or m");
}

// Whether the mesh consists of tetrahedra; other sources are problems.
bool IsOfTetrahedra(const BodySource& source, Method method, Problems& problems) {
  const std::string the_method = std::string("the ") + kMethodNames[static_cast<std::size_t>(method)] + " method";
  const std::string path = JoinPath(source.path, "mesh");
  if (source.wire.mesh().has_image()) {
    problems.Add(JoinPath(path, "image"), the_method + " does not support images",
                 "`fascicle mesh` fills the labels of an image with tetrahedra, `fascicle segment` makes labels; or "
                 "use the voxel method");
    return false;
  }
  if (source.wire.mesh().has_surface()) {
    problems.Add(JoinPath(path, "surface"), the_method + " needs tetrahedra",
                 "`fascicle mesh` fills a closed surface with them; or use the eulerian method");
    return false;
  }
  return true;
}

std::optional<TetMesh> TetrahedraOfFile(const BodySource& source, const std::string& path, MeshRemarks& remarks,
                                        std::vector<std::string>& notes, Problems& problems) {
  CheckUnit(source, "mesh", problems);
  auto mesh = ReadMeshFile(source, path, remarks, notes, problems);
  if (!mesh || !Spend(static_cast<std::int64_t>(mesh->tetrahedra.size()), "tetrahedra", source.budget,
                      JoinPath(path, "file"), "use a coarser mesh", problems)) {
    return std::nullopt;
  }
  const double metres = MetresIn(source.wire.unit());
  for (Vec3& x : mesh->nodes) x *= metres;
  for (CurvedEdge& edge : mesh->curved_edges) edge.middle *= metres;
  OrientConsistently(*mesh);
  return mesh;
}

std::optional<TetMesh> TetrahedraOfShape(const BodySource& source, const std::string& path, Problems& problems) {
  CheckElements(source.wire.mesh(), path, problems);
  const auto shape = CheckShape(source.wire.mesh(), path, problems);
  if (!shape || !Spend(shape->tetrahedra, "tetrahedra", source.budget, shape->path, "use fewer divisions", problems)) {
    return std::nullopt;
  }
  return MakeShape(source.wire.mesh(), MetresIn(source.wire.unit()), source.cells);
}

std::optional<BrickMesh> BricksOfBox(const BodySource& source, const std::string& path, Problems& problems) {
  const v1::BoxShape& box = source.wire.mesh().box();
  if (!ObeysRules(box)) return std::nullopt;
  std::int64_t count = 1;
  for (const std::int32_t divisions : box.divisions()) count *= divisions;
  if (!Spend(count, "voxels", source.budget, path, "use fewer divisions", problems)) return std::nullopt;
  return MakeBrickMesh(BoxOfVoxels(box, MetresIn(source.wire.unit())), source.tools.stop);
}

std::optional<BrickMesh> BricksOfImage(const BodySource& source, const std::string& path,
                                       std::vector<std::string>& notes, Problems& problems) {
  auto grid = TranslateImage(source, path, notes, problems);
  if (!grid) return std::nullopt;
  BrickMesh mesh = MakeBrickMesh(std::move(*grid), source.tools.stop);
  if (!Spend(static_cast<std::int64_t>(mesh.bricks.size()), "voxels", source.budget, path,
             "use a higher level, or a smaller region", problems)) {
    return std::nullopt;
  }
  return mesh;
}

}  // namespace

std::string SourcePath(const v1::Mesh& mesh, const std::string& body_path) {
  const auto* field =
      mesh.GetReflection()->GetOneofFieldDescriptor(mesh, v1::Mesh::descriptor()->FindOneofByName("source"));
  const std::string path = JoinPath(body_path, "mesh");
  return field == nullptr ? path : JoinPath(path, field->name());
}

std::optional<TranslatedTetrahedra> TranslateTetrahedra(const BodySource& source, Method method,
                                                        std::vector<std::string>& notes, Problems& problems) {
  const StageTimer timer(source.tools.profile, "meshes");
  const std::string path = JoinPath(source.path, "mesh");
  if (!NamesSource(source, "file, box, fusiform, torus, sphere", problems) ||
      !IsOfTetrahedra(source, method, problems)) {
    return std::nullopt;
  }
  MeshRemarks remarks;
  auto mesh = source.wire.mesh().has_file() ? TetrahedraOfFile(source, path, remarks, notes, problems)
                                            : TetrahedraOfShape(source, path, problems);
  if (!mesh) return std::nullopt;
  Problems own;
  if (source.wire.mesh().has_file()) {
    CheckMesh(*mesh, own, source.tools.stop);
  } else {
    CheckMadeMesh(*mesh, own, source.tools.stop);
  }
  problems.Append(SourcePath(source.wire.mesh(), source.path), own);
  if (!IsAddressable(*mesh)) return std::nullopt;
  return TranslatedTetrahedra{std::move(*mesh), own.empty(), std::move(remarks.node_places)};
}

std::optional<BrickMesh> TranslateBricks(const BodySource& source, std::vector<std::string>& notes,
                                         Problems& problems) {
  const StageTimer timer(source.tools.profile, "meshes");
  const std::string path = JoinPath(source.path, "mesh");
  if (!NamesSource(source, "image, box", problems)) return std::nullopt;
  if (source.wire.mesh().has_image()) return BricksOfImage(source, JoinPath(path, "image"), notes, problems);
  if (source.wire.mesh().has_box()) return BricksOfBox(source, JoinPath(path, "box"), problems);
  problems.Add(path, "the voxel method needs an image or a box",
               "voxels of an image: image; tetrahedra need the tet method");
  return std::nullopt;
}

std::optional<TriangleMesh> TranslateSurfaceFile(const BodySource& source, std::vector<std::string>& notes,
                                                 Problems& problems) {
  const StageTimer timer(source.tools.profile, "meshes");
  const std::string path = JoinPath(source.path, "mesh");
  const std::string file_path = JoinPath(path, "surface");
  CheckUnit(source, "surface", problems);
  CheckElements(source.wire.mesh(), path, problems);
  const v1::FileRef& file = source.wire.mesh().surface();
  const auto bytes = ReadFile(file, file_path, source.assets, problems);
  if (!bytes || file.path().empty()) return std::nullopt;
  Problems own;
  std::vector<std::string> found;
  auto surface = ReadSurface(file.path(), *bytes, own, source.tools.stop, &found);
  AddNotes(found, file_path, notes);
  problems.Append(file_path, own);
  if (!surface || !Spend(static_cast<std::int64_t>(surface->triangles.size()), "triangles", source.budget, file_path,
                         "use a coarser surface", problems)) {
    return std::nullopt;
  }
  // Without a unit, its size relative to the grid is unknown.
  if (source.wire.unit() == v1::LENGTH_UNIT_UNSPECIFIED) return std::nullopt;
  for (Vec3& x : surface->nodes) x *= MetresIn(source.wire.unit());
  return surface;
}

}  // namespace fascicle::server
