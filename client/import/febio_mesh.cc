#include "client/import/febio_mesh.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "client/import/sections.h"
#include "client/import/tetrahedra.h"
#include "core/base/stop.h"
#include "core/geometry/mesh_readers.h"
#include "core/geometry/text_scanner.h"

namespace fascicle::client {
namespace {

class MeshConverter {
 public:
  MeshConverter(const Mesh& mesh, const std::stop_token& stop) : mesh_(mesh), stop_(stop) {}

  RawMesh Convert() {
    raw_.node_numbers = mesh_.ids;
    raw_.nodes = mesh_.nodes;
    for (const Part& part : mesh_.parts) AddPart(part);
    for (const auto& [name, ids] : mesh_.element_sets) AddElementSet(name, ids);
    for (const auto& [name, surface] : mesh_.surfaces) AddSurface(name, surface);
    for (const auto& [name, set] : mesh_.node_sets) {
      // Every list of nodes is a set, too.
      if (std::string_view(set.node.name()) != "Nodes") AddNodeSet(name, set);
    }
    return std::move(raw_);
  }

 private:
  std::int32_t NewTag(int dimension, const std::string& name) {
    const auto tag = static_cast<std::int32_t>(raw_.names.size() + 1);
    raw_.names.push_back({dimension, tag, name});
    return tag;
  }

  std::int64_t NumberOf(std::int32_t node) const { return mesh_.ids[static_cast<std::size_t>(node)]; }

  static bool IsTetrahedron(const Part& part) { return part.shape == Shape::kTet4 || part.shape == Shape::kTet10; }

  static bool HasVolume(const Part& part) { return part.shape != Shape::kNoVolume; }

  void AddPart(const Part& part) {
    if (!HasVolume(part)) return first_.push_back(0);
    const std::int32_t tag = NewTag(3, part.name);
    const std::size_t count = part.count;
    first_.push_back(IsTetrahedron(part) ? raw_.tetrahedra.size() : raw_.solids.size());
    for (std::size_t e = 0; e < part.size(); ++e) {
      ThrowIfStopped(stop_);
      const std::int32_t* nodes = part.nodes.data() + e * count;
      if (!IsTetrahedron(part)) {
        RawSolid solid{SolidShapeOf(part.shape), {}};
        std::transform(nodes, nodes + CornersOf(solid.shape), solid.nodes.begin(),
                       [&](std::int32_t n) { return NumberOf(n); });
        raw_.solids.push_back(solid);
        raw_.solid_tags.push_back(tag);
        continue;
      }
      auto& corners = raw_.tetrahedra.emplace_back();
      std::transform(nodes, nodes + 4, corners.begin(), [&](std::int32_t n) { return NumberOf(n); });
      raw_.tetrahedron_tags.push_back(tag);
      if (part.shape != Shape::kTet10) continue;
      auto& middles = raw_.middles.emplace_back();
      std::transform(nodes + 4, nodes + 10, middles.begin(), [&](std::int32_t n) { return NumberOf(n); });
    }
  }

  void AddElementSet(const std::string& name, const std::vector<std::int64_t>& ids) {
    const std::int32_t tag = NewTag(3, name);
    for (const std::int64_t id : ids) {
      const auto found = mesh_.element_index.find(id);
      if (found == mesh_.element_index.end()) continue;
      const auto part = static_cast<std::size_t>(found->second.first);
      if (!HasVolume(mesh_.parts[part])) continue;
      const auto index = static_cast<std::int64_t>(first_[part]) + found->second.second;
      (IsTetrahedron(mesh_.parts[part]) ? raw_.further_tags : raw_.further_solid_tags).push_back({index, tag});
    }
  }

  void AddSurface(const std::string& name, const Surface& surface) {
    const std::int32_t tag = NewTag(2, name);
    for (const Facet& facet : surface.facets) {
      const auto at = [&](std::size_t k) { return NumberOf(facet.node[k]); };
      if (facet.corners == 3) {
        raw_.triangles.push_back({at(0), at(1), at(2)});
        raw_.triangle_tags.push_back(tag);
      } else {
        raw_.quads.push_back({at(0), at(1), at(2), at(3)});
        raw_.quad_tags.push_back(tag);
      }
    }
  }

  void AddNodeSet(const std::string& name, const NodeSet& set) {
    const std::int32_t tag = NewTag(0, name);
    for (const std::int32_t n : set.nodes) {
      raw_.points.push_back({NumberOf(n)});
      raw_.point_tags.push_back(tag);
    }
  }

  const Mesh& mesh_;
  const std::stop_token& stop_;
  std::vector<std::size_t> first_;  // of each part, in the list of tetrahedra or of solids
  RawMesh raw_;
};

}  // namespace

std::optional<TetMesh> ReadFebioMesh(const std::string& name, std::string_view bytes, bool split_solids,
                                     Problems& problems, const std::stop_token& stop, MeshRemarks& remarks) {
  Problems own;
  XmlSource source(name, WithoutByteOrderMark(bytes), own);
  std::optional<TetMesh> result;
  if (own.empty()) {
    const pugi::xml_node root = source.root();
    Model model;
    model.version = root.attribute("version").value();
    const char* name_of_mesh = model.version == "2.5" ? "Geometry" : "Mesh";
    if (std::string_view(root.name()) != "febio_spec" || !root.child(name_of_mesh)) {
      source.Fail(root, "the file has no mesh of FEBio 2.5, 3 or 4", "save the model again with FEBio Studio");
    }
    for (const pugi::xml_node section : root.children(name_of_mesh)) ReadMesh(section, source, model);
    for (const Part& part : model.mesh.parts) IsUsable(part, split_solids || part.shape == Shape::kHex8, source);
    if (own.empty()) {
      RawMesh raw = MeshConverter(model.mesh, stop).Convert();
      for (const Notice& notice : source.notices) raw.notes.push_back(notice.where + ": " + notice.message);
      result = FinishMesh(std::move(raw), split_solids ? Solids::kSplit : Solids::kKeep, own, stop, &remarks);
    }
  }
  problems.Append("", own);
  return own.empty() ? std::move(result) : std::nullopt;
}

}  // namespace fascicle::client
