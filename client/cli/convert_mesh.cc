#include "client/cli/convert_mesh.h"

#include <nlohmann/json.hpp>

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

#include "client/cli/input_file.h"
#include "client/exodus/exodus_reader.h"
#include "client/import/febio_mesh.h"
#include "client/lib/replace_file.h"
#include "core/geometry/hexahedron.h"
#include "core/geometry/mesh_checks.h"
#include "core/geometry/mesh_io.h"
#include "core/geometry/mesh_writer.h"
#include "core/geometry/text_scanner.h"

namespace fascicle::client {
namespace {

namespace fs = std::filesystem;

// What has a physical tag. Gmsh counts tags for each dimension: 0 nodes, 2 triangles, 3 tetrahedra.
struct TaggedPart {
  std::string name;  // may be empty
  std::int64_t count = 0;
  double measure = 0;  // volume or area
};
using TaggedParts = std::map<std::pair<int, std::int32_t>, TaggedPart>;  // by dimension and tag

struct Converted {
  TetMesh mesh;
  MeshRemarks remarks;
  MeshReport report;  // in metres
  TaggedParts parts;
};

void RefuseConversion(const Problems& problems, const std::string& file) {
  if (problems.empty()) return;
  Error error{Error::Kind::kInvalid, "the mesh " + file + " can't be converted", "INVALID_MESH", {}};
  for (const Problem& problem : problems.kept()) {
    error.problems.Add(problem.path.empty() ? file : problem.path, problem.message, problem.hint);
  }
  throw CommandError(std::move(error));
}

std::optional<TetMesh> Read(const Conversion& conversion, const std::stop_token& stop, MeshRemarks& remarks,
                            Problems& problems) {
  const fs::path path = conversion.input;
  const std::string extension = path.extension().string();
  const std::optional<std::string> bytes = ReadInputFile(path, problems);
  if (!bytes) return std::nullopt;
  if (IsExodusName(path)) return ReadExodus(path, conversion.split_hexahedra, problems, stop, remarks);
  if (SameInAnyCase(extension, ".feb")) {
    return ReadFebioMesh(path.filename(), *bytes, conversion.split_hexahedra, problems, stop, remarks);
  }
  std::optional<std::string> elements;
  if (SameInAnyCase(extension, ".node")) {
    fs::path beside = path;
    beside.replace_extension(extension == ".NODE" ? ".ELE" : ".ele");
    Problems own;
    elements = ReadInputFile(beside, own);
    for (const Problem& problem : own.kept()) problems.Add(beside, problem.message, problem.hint);
    if (!elements) return std::nullopt;
  }
  const MeshFile file = {.name = conversion.input,
                         .bytes = *bytes,
                         .element_bytes = elements ? std::string_view(*elements) : std::string_view(),
                         .solids = conversion.split_hexahedra ? Solids::kSplit : Solids::kKeep};
  return ReadMesh(file, problems, stop, &remarks);
}

// Checks the mesh in metres, as a scene would.
MeshReport Check(const TetMesh& mesh, const std::string& unit, const std::stop_token& stop, Problems& problems) {
  TetMesh in_metres = mesh;
  const double metres = unit == "mm" ? 1e-3 : unit == "cm" ? 1e-2 : 1;
  for (Vec3& node : in_metres.nodes) node *= metres;
  for (CurvedEdge& edge : in_metres.curved_edges) edge.middle *= metres;
  Problems own;
  const MeshReport report = CheckMesh(in_metres, own, stop);
  for (const Problem& problem : own.kept()) {
    const bool is_size = problem.message.find(" long; no muscle") != std::string::npos;
    problems.Add(problem.path, problem.message,
                 is_size ? "the unit is taken as " + unit + ": give another one with --unit" : problem.hint);
  }
  return report;
}

double AreaOf(const TetMesh& mesh, const Triangle& triangle) {
  const auto& [a, b, c] = triangle;
  return (mesh.nodes[b] - mesh.nodes[a]).cross(mesh.nodes[c] - mesh.nodes[a]).norm() / 2;
}

TaggedParts PartsOf(const TetMesh& mesh) {
  TaggedParts parts;
  const auto add = [&](int dimension, std::int32_t tag, double measure, bool counts = true) {
    if (tag == 0) return;  // none
    TaggedPart& part = parts[{dimension, tag}];
    part.count += counts ? 1 : 0;
    part.measure += measure;
  };
  // The first tetrahedron of each hexahedron counts for it.
  const std::vector<std::int32_t> hexahedra = HexahedraOfTetrahedra(mesh);
  const auto add_tetrahedron = [&](std::size_t t, std::int32_t tag) {
    add(3, tag, SignedVolume(mesh, t), hexahedra.empty() || t == 0 || hexahedra[t] != hexahedra[t - 1]);
  };
  for (std::size_t t = 0; t < mesh.tetrahedron_tags.size(); ++t) add_tetrahedron(t, mesh.tetrahedron_tags[t]);
  for (const auto& [t, tag] : mesh.further_tags) add_tetrahedron(static_cast<std::size_t>(t), tag);
  for (std::size_t i = 0; i < mesh.triangle_tags.size(); ++i) {
    add(2, mesh.triangle_tags[i], AreaOf(mesh, mesh.tagged_triangles[i]));
  }
  for (const std::int32_t tag : mesh.node_tags) add(0, tag, 0);
  return parts;
}

// The names of tags that occur, without characters that the file's format does not allow.
std::vector<TagName> NamesOf(const MeshRemarks& remarks, TaggedParts& parts) {
  std::vector<TagName> names;
  for (TagName name : remarks.names) {
    const auto part = parts.find({name.dimension, name.tag});
    if (part == parts.end()) continue;
    std::replace_if(
        name.name.begin(), name.name.end(), [](unsigned char c) { return c == '"' || c < ' '; }, '_');
    part->second.name = name.name;
    names.push_back(std::move(name));
  }
  return names;
}

double InDegrees(double radians) { return radians * 180 / std::numbers::pi; }

const char* ElementsOf(const TetMesh& mesh) { return mesh.hexahedra.empty() ? "tetrahedra" : "hexahedra"; }

const char* KindOf(int dimension, const TetMesh& mesh) {
  return dimension == 3 ? ElementsOf(mesh) : dimension == 2 ? "triangles" : "nodes";
}

Json ReportJson(const Conversion& conversion, const Converted& converted) {
  Json regions = Json::array();
  for (const auto& [key, part] : converted.parts) {
    const auto& [dimension, tag] = key;
    regions.push_back({{"name", part.name},
                       {"dimension", dimension},
                       {"physical_tag", tag},
                       {KindOf(dimension, converted.mesh), part.count}});
    if (dimension > 0) regions.back()[dimension == 3 ? "volume" : "area"] = part.measure;
  }
  return {{"mesh", conversion.out},
          {"unit", conversion.unit},
          {ElementsOf(converted.mesh), ElementCount(converted.mesh)},
          {"nodes", converted.mesh.nodes.size()},
          {"curved_edges", converted.mesh.curved_edges.size()},
          {"volume", TotalVolume(converted.mesh)},
          {"smallest_dihedral_angle", InDegrees(converted.report.smallest_dihedral_angle)},
          {"notes", converted.remarks.notes},
          {"regions", std::move(regions)}};
}

void PrintReport(const Conversion& conversion, const Converted& converted) {
  const TetMesh& mesh = converted.mesh;
  const char* unit = conversion.unit.c_str();
  for (const std::string& note : converted.remarks.notes) std::printf("note: %s\n", note.c_str());
  std::printf("%-19s %zu\nnodes               %zu\n", ElementsOf(mesh), ElementCount(mesh), mesh.nodes.size());
  if (!mesh.curved_edges.empty()) std::printf("curved edges        %zu\n", mesh.curved_edges.size());
  std::printf("smallest angle      %.1f degrees\nvolume              %.6g %s^3\n",
              InDegrees(converted.report.smallest_dihedral_angle), TotalVolume(mesh), unit);
  const Vec3 size = converted.report.highest - converted.report.lowest;
  std::printf("size                %.4g x %.4g x %.4g m, if the unit is %s\n", size.x(), size.y(), size.z(), unit);
  std::size_t width = 12;
  for (const auto& [key, part] : converted.parts) width = std::max(width, part.name.size());
  for (const auto& [key, part] : converted.parts) {
    const auto& [dimension, tag] = key;
    std::printf("region %-*s physical tag %d: %lld %s", static_cast<int>(width), part.name.c_str(),
                static_cast<int>(tag), static_cast<long long>(part.count), KindOf(dimension, mesh));
    if (dimension > 0) std::printf(", %.4g %s^%d", part.measure, unit, dimension);
    std::printf("\n");
  }
  std::cout << "written to " << conversion.out << '\n';
}

}  // namespace

std::string ConvertibleExtensions() {
  return KnownMeshExtensions() + ", .feb, and Exodus' .e, .exo, .ex2, .exii, .g, .gen";
}

void ConvertMesh(const Conversion& conversion, const Context& context, const std::stop_token& stop) {
  Problems problems;
  Converted converted;
  std::optional<TetMesh> mesh = Read(conversion, stop, converted.remarks, problems);
  RefuseConversion(problems, conversion.input);
  converted.mesh = std::move(*mesh);
  OrientConsistently(converted.mesh);
  converted.report = Check(converted.mesh, conversion.unit, stop, problems);
  RefuseConversion(problems, conversion.input);
  converted.parts = PartsOf(converted.mesh);
  const std::vector<TagName> names = NamesOf(converted.remarks, converted.parts);
  ReplaceFile(conversion.out, GmshText(converted.mesh, names, stop));
  if (context.json) {
    PrintJson(ReportJson(conversion, converted));
  } else {
    PrintReport(conversion, converted);
  }
}

}  // namespace fascicle::client
