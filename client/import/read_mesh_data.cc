// <MeshData>: fibres and material axes of each element, and numbers of each facet [FEBio User Manual, 3.8].
#include <string_view>
#include <utility>

#include "client/import/sections.h"
#include "core/geometry/text_scanner.h"

namespace fascicle::client {
namespace {

class ElementDataReader {
 public:
  ElementDataReader(XmlSource& source, Model& model) : source_(source), model_(model) {}

  void Read(pugi::xml_node section) {
    // Version 4 has `type` for fibres and axes, version 3 `var`; maps have a name.
    std::string kind = section.attribute("var").value();
    if (kind.empty()) kind = section.attribute("type").value();
    const std::string name = section.attribute("name").value();
    const bool is_map = kind.empty() && !name.empty();
    if (is_map && std::string_view(section.attribute("data_type").value()) != "vec3")
      return;  // reported as not supported
    if (!is_map && kind != "fiber" && kind != "mat_axis") return;
    source_.TakeAll(section);
    const std::string set = source_.Required(section, "elem_set");
    if (set.empty()) return;
    const std::vector<std::int64_t>* ids = FindElements(model_.mesh, set);
    if (ids == nullptr) return source_.Fail(section, "there is no element set or part " + Quoted(set));
    for (const pugi::xml_node node : section.children()) {
      if (node.type() != pugi::node_element) continue;
      const auto lid = source_.IntegerAttribute(node, "lid");
      if (!lid) continue;
      if (*lid < 1 || *lid > static_cast<std::int64_t>(ids->size())) {
        source_.Fail(node,
                     "lid " + std::to_string(*lid) + " is not in the set, which has " + std::to_string(ids->size()) +
                         " elements",
                     "count the elements of the set from 1");
        continue;
      }
      const std::int64_t id = (*ids)[static_cast<std::size_t>(*lid - 1)];
      if (kind == "mat_axis") {
        if (const auto frame = ReadFrame(node, source_)) model_.data.axes[id] = *frame;
      } else if (const auto vector = Direction(node)) {
        (is_map ? model_.data.maps[name] : model_.data.fibres)[id] = *vector;
      }
    }
  }

 private:
  std::optional<Vec3> Direction(pugi::xml_node node) {
    const auto vector = source_.Vector(node);
    if (!vector) return std::nullopt;
    const Vec3 unit = vector->stableNormalized();
    if (unit.norm() > 0.5) return unit;
    source_.Fail(node, "the direction is zero", "give a direction for every element");
    return std::nullopt;
  }

  XmlSource& source_;
  Model& model_;
};

// One number for each facet; other data are reported as not supported.
void ReadSurfaceData(pugi::xml_node section, XmlSource& source, Model& model) {
  const std::string_view type = section.attribute("data_type").as_string("scalar");
  const std::string name = section.attribute("name").value();
  if (type != "scalar" || name.empty() || section.attribute("generator") || section.attribute("type")) return;
  source.TakeAll(section);
  SurfaceMap map;
  map.surface = source.Required(section, "surface");
  const auto surface = model.mesh.surfaces.find(map.surface);
  if (surface == model.mesh.surfaces.end()) {
    return source.Fail(section, "there is no surface " + Quoted(map.surface), "name a Surface of the mesh");
  }
  map.values.assign(surface->second.facets.size(), 0);
  for (const pugi::xml_node node : section.children("face")) {
    const auto lid = source.IntegerAttribute(node, "lid");
    const double value = source.Number(node);
    if (!lid) continue;
    if (*lid < 1 || *lid > static_cast<std::int64_t>(map.values.size())) {
      source.Fail(node, "lid " + std::to_string(*lid) + " is not a facet of the surface", "count its facets from 1");
      continue;
    }
    map.values[static_cast<std::size_t>(*lid - 1)] = value;
  }
  model.surface_maps[name] = std::move(map);
}

}  // namespace

void ReadMeshData(pugi::xml_node section, XmlSource& source, Model& model) {
  source.Take(section);
  ElementDataReader reader(source, model);
  for (const pugi::xml_node node : section.children("ElementData")) reader.Read(node);
  for (const pugi::xml_node node : section.children("SurfaceData")) ReadSurfaceData(node, source, model);
}

}  // namespace fascicle::client
