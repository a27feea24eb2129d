// <Mesh> and <MeshDomains>: nodes, elements, sets, and the material of each part [FEBio User Manual, 3.6 and 3.7].
#include <algorithm>
#include <set>
#include <string_view>
#include <utility>

#include "client/import/sections.h"
#include "core/geometry/text_scanner.h"

namespace fascicle::client {
namespace {

constexpr std::size_t kMaxNodes = 50'000'000;

struct ShapeName {
  std::string_view name;
  Shape shape;
};
constexpr ShapeName kShapes[] = {{"tet4", Shape::kTet4},
                                 {"tet10", Shape::kTet10},
                                 {"hex8", Shape::kHex8},
                                 {"penta6", Shape::kPenta6},
                                 {"pyra5", Shape::kPyra5}};

// Solid elements whose omission would leave a hole in the body, and elements without volume.
bool IsOtherSolid(std::string_view type) {
  return type.starts_with("tet") || type.starts_with("hex") || type.starts_with("penta") || type.starts_with("pyra");
}

class MeshReader {
 public:
  MeshReader(bool split_hexahedra, XmlSource& source, Mesh& mesh)
      : split_hexahedra_(split_hexahedra), source_(source), mesh_(mesh) {}

  void Read(pugi::xml_node section) {
    source_.Take(section);
    // Nodes are read before everything that refers to them, whatever the order in the file.
    for (const pugi::xml_node node : section.children("Nodes")) ReadNodes(node);
    for (const pugi::xml_node node : section.children("Elements")) ReadElements(node);
    for (const pugi::xml_node node : section.children()) {
      const std::string_view name = node.name();
      if (name == "NodeSet") ReadNodeSet(node);
      if (name == "Surface") ReadSurface(node);
      if (name == "ElementSet") ReadElementSet(node);
      if (name == "Edge" || name == "SurfacePair" || name == "DiscreteSet" || name == "PartList") {
        source_.TakeAll(node);  // names only; their users are reported
      }
    }
    if (mesh_.nodes.empty()) source_.Fail(section, "has no nodes", "is the file complete?");
    if (mesh_.parts.empty() && !any_elements_) source_.Fail(section, "has no elements", "is the file complete?");
  }

 private:
  void ReadNodes(pugi::xml_node section) {
    source_.TakeAll(section);
    NodeSet set;
    set.node = section;
    for (const pugi::xml_node node : section.children()) {
      if (node.type() != pugi::node_element) continue;
      if (std::string_view(node.name()) != "node") {
        source_.Fail(node, "is not a node", "write <node id=\"...\">x,y,z</node>");
        continue;
      }
      const auto id = source_.IntegerAttribute(node, "id");
      const auto position = source_.Vector(node);
      if (!id) any_unnumbered_ = true;
      if (id && !position) mesh_.index_of.try_emplace(*id, -1);  // reported once, here and not where it is used
      if (!id || !position) continue;
      if (mesh_.nodes.size() == kMaxNodes) return source_.Fail(node, "is one node too many", "use a coarser mesh");
      const auto index = static_cast<std::int32_t>(mesh_.nodes.size());
      if (!mesh_.index_of.try_emplace(*id, index).second) {
        source_.Fail(node, "node " + std::to_string(*id) + " is given twice", "number the nodes uniquely");
        continue;
      }
      mesh_.nodes.push_back(*position);
      mesh_.ids.push_back(*id);
      set.nodes.push_back(index);
    }
    if (section.attribute("name")) mesh_.node_sets.try_emplace(section.attribute("name").value(), std::move(set));
  }

  // The index of a node; -1, with a problem, if it does not exist.
  std::int32_t Find(std::int64_t id, pugi::xml_node node) {
    const auto found = mesh_.index_of.find(id);
    if (found != mesh_.index_of.end()) return found->second;
    if (any_unnumbered_) return -1;
    source_.Fail(node, "refers to node " + std::to_string(id) + ", which does not exist", "is the file complete?");
    return -1;
  }

  std::optional<Shape> ShapeOf(pugi::xml_node section) {
    const std::string type = source_.Required(section, "type");
    any_elements_ = true;
    if (type.empty()) return std::nullopt;
    for (const auto& [name, shape] : kShapes) {
      if (name != type) continue;
      if (split_hexahedra_ || shape == Shape::kTet4 || shape == Shape::kTet10) return shape;
      source_.Fail(section, "consists of " + Quoted(type) + " elements; fascicle has tetrahedra only",
                   "--split-hexahedra splits them, or mesh the body with tet4 or tet10");
      return std::nullopt;
    }
    if (IsOtherSolid(type)) {
      source_.Fail(section, "consists of " + Quoted(type) + " elements, which are not supported",
                   "mesh the body with tet4 or tet10");
    } else {
      source_.Tell(Notice::Kind::kNotTaken, section, "elements of type " + Quoted(type) + " have no volume");
    }
    return std::nullopt;
  }

  void ReadElements(pugi::xml_node section) {
    source_.TakeAll(section);
    const std::string name = source_.Required(section, "name");
    const std::optional<Shape> shape = ShapeOf(section);
    if (!name.empty() && !mesh_.part_names.insert(name).second) {
      source_.Fail(section, "there is a part " + Quoted(name) + " already", "name the parts uniquely");
    }
    if (!shape) return;
    Part part;
    part.name = name;
    part.node = section;
    part.shape = *shape;
    bool empty = true;
    for (const pugi::xml_node node : section.children()) {
      if (node.type() != pugi::node_element) continue;
      ReadElement(node, part);
      empty = false;
    }
    if (empty) return source_.Fail(section, "has no elements", "is the file complete?");
    mesh_.part_index.try_emplace(part.name, mesh_.parts.size());
    mesh_.parts.push_back(std::move(part));
  }

  void ReadElement(pugi::xml_node node, Part& part) {
    const std::string_view name = node.name();
    if (name != "elem" && name != "e")
      return source_.Fail(node, "is not an element", "write <elem id=\"...\">n1,n2,...");
    const auto count = static_cast<std::size_t>(NodesOf(part.shape));
    const auto id = source_.IntegerAttribute(node, "id");
    const auto numbers = source_.Integers(node, count);
    if (!id || !numbers) return;
    const std::pair place(static_cast<std::int32_t>(mesh_.parts.size()), static_cast<std::int32_t>(part.size()));
    if (!mesh_.element_index.try_emplace(*id, place).second) {
      return source_.Fail(node, "element " + std::to_string(*id) + " is given twice", "number the elements uniquely");
    }
    auto sorted = *numbers;
    std::sort(sorted.begin(), sorted.end());
    if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) {
      return source_.Fail(node, "has a node twice", "mesh the body again");
    }
    std::array<std::int32_t, 10> indices;
    for (std::size_t n = 0; n < count; ++n) {
      indices[n] = Find((*numbers)[n], node);
      if (indices[n] < 0) return;
    }
    part.ids.push_back(*id);
    part.nodes.insert(part.nodes.end(), indices.begin(), indices.begin() + static_cast<std::ptrdiff_t>(count));
  }

  // Numbers as text, or as elements with an id: <n id="1"/>.
  std::optional<std::vector<std::int64_t>> Members(pugi::xml_node node) {
    source_.TakeAll(node);
    auto numbers = source_.Integers(node);
    if (!numbers) return numbers;
    for (const pugi::xml_node child : node.children()) {
      if (child.type() != pugi::node_element) continue;
      const auto id = source_.IntegerAttribute(child, "id");
      if (!id) return std::nullopt;
      numbers->push_back(*id);
    }
    return numbers;
  }

  void ReadNodeSet(pugi::xml_node node) {
    const std::string name = source_.Required(node, "name");
    const auto numbers = Members(node);
    NodeSet set;
    set.node = node;
    if (numbers) {
      if (numbers->empty()) source_.Fail(node, "is an empty set", "is the file complete?");
      for (const std::int64_t id : *numbers) {
        const std::int32_t index = Find(id, node);
        if (index < 0) break;
        set.nodes.push_back(index);
      }
    }
    std::sort(set.nodes.begin(), set.nodes.end());
    set.nodes.erase(std::unique(set.nodes.begin(), set.nodes.end()), set.nodes.end());
    if (name.empty()) return;
    const auto [place, is_new] = mesh_.node_sets.try_emplace(name, set);
    if (is_new) return;
    // The nodes of a <Nodes> section form a set of its name, which a proper set replaces.
    if (std::string_view(place->second.node.name()) == "Nodes") {
      place->second = std::move(set);
    } else {
      source_.Fail(node, "there is a node set " + Quoted(name) + " already", "name the sets uniquely");
    }
  }

  void ReadSurface(pugi::xml_node section) {
    source_.TakeAll(section);
    const std::string name = source_.Required(section, "name");
    Surface surface;
    surface.node = section;
    bool empty = true;
    for (const pugi::xml_node node : section.children()) {
      if (node.type() != pugi::node_element) continue;
      ReadFacet(node, surface);
      empty = false;
    }
    if (empty) source_.Fail(section, "has no facets", "is the file complete?");
    if (!name.empty() && !mesh_.surfaces.try_emplace(name, std::move(surface)).second) {
      source_.Fail(section, "there is a surface " + Quoted(name) + " already", "name the surfaces uniquely");
    }
  }

  void ReadFacet(pugi::xml_node node, Surface& surface) {
    const std::string_view kind = node.name();
    const bool is_triangle = kind == "tri3" || kind == "tri6" || kind == "tri7";
    if (!is_triangle && kind != "quad4" && kind != "quad8" && kind != "quad9") {
      return source_.Fail(node, "is not a facet", "write tri3, tri6 or quad4");
    }
    const auto count = static_cast<std::size_t>(kind.back() - '0');
    const auto numbers = source_.Integers(node, count);
    if (!numbers) return;
    Facet facet;
    facet.corners = is_triangle ? 3 : 4;
    facet.node.fill(-1);
    for (std::size_t n = 0; n < count; ++n) {
      const std::int32_t index = Find((*numbers)[n], node);
      if (index < 0) return;
      if (n < static_cast<std::size_t>(facet.corners)) {
        facet.node[n] = index;
      } else {
        surface.middles.push_back(index);
      }
    }
    surface.facets.push_back(facet);
  }

  void ReadElementSet(pugi::xml_node node) {
    const std::string name = source_.Required(node, "name");
    auto numbers = Members(node);
    if (name.empty() || !numbers) return;
    for (const std::int64_t id : *numbers) {
      if (mesh_.element_index.contains(id)) continue;
      source_.Fail(node, "refers to element " + std::to_string(id) + ", which does not exist", "is the file complete?");
      break;
    }
    if (!mesh_.element_sets.try_emplace(name, std::move(*numbers)).second) {
      source_.Fail(node, "there is an element set " + Quoted(name) + " already", "name the sets uniquely");
    }
  }

  bool split_hexahedra_;
  XmlSource& source_;
  Mesh& mesh_;
  bool any_elements_ = false;
  bool any_unnumbered_ = false;  // nodes without a number
};

// Assigns materials to parts, and drops rigid parts.
class MaterialAssignment {
 public:
  MaterialAssignment(const Model& model, XmlSource& source) : model_(model), source_(source) {
    for (std::size_t m = 0; m < model.materials.size(); ++m) {
      const ImportedMaterial& material = model.materials[m];
      index_of_.try_emplace(material.name, m);
      index_of_.try_emplace(std::to_string(material.id), m);
    }
  }

  // `part` is null if the part is not supported.
  void Assign(const std::string& name, pugi::xml_node node, Part* part) const {
    const auto found = index_of_.find(name);
    if (found == index_of_.end()) {
      source_.Fail(node, "there is no material " + Quoted(name), "materials of the model: " + Names());
    } else if (part == nullptr) {
      return;
    } else if (model_.materials[found->second].rigid) {
      source_.Tell(Notice::Kind::kNotTaken, node,
                   "a rigid body: nodes that it shares with other parts are free, unless a node set constrains them");
    } else {
      part->material = static_cast<std::int32_t>(found->second);
    }
  }

 private:
  std::string Names() const {
    std::string names;
    for (const ImportedMaterial& material : model_.materials) {
      if (names.size() > 200) return names + ", ...";
      names += (names.empty() ? "" : ", ") + Quoted(material.name);
    }
    return names.empty() ? "none" : names;
  }

  const Model& model_;
  XmlSource& source_;
  std::unordered_map<std::string, std::size_t> index_of_;
};

}  // namespace

int NodesOf(Shape shape) {
  switch (shape) {
    case Shape::kTet4:
      return 4;
    case Shape::kTet10:
      return 10;
    case Shape::kHex8:
      return 8;
    case Shape::kPenta6:
      return 6;
    case Shape::kPyra5:
      return 5;
  }
  return 0;
}

const std::vector<std::int64_t>* FindElements(const Mesh& mesh, const std::string& name) {
  if (const auto set = mesh.element_sets.find(name); set != mesh.element_sets.end()) return &set->second;
  const auto part = mesh.part_index.find(name);
  return part == mesh.part_index.end() ? nullptr : &mesh.parts[part->second].ids;
}

void ReadMesh(pugi::xml_node section, bool split_hexahedra, XmlSource& source, Model& model) {
  MeshReader(split_hexahedra, source, model.mesh).Read(section);
}

void ReadMeshDomains(pugi::xml_node section, XmlSource& source, Model& model) {
  source.Take(section);
  const MaterialAssignment materials(model, source);
  std::unordered_map<std::string, Part*> parts;
  for (Part& part : model.mesh.parts) parts.emplace(part.name, &part);
  std::set<std::string> seen;
  for (const pugi::xml_node node : section.children("SolidDomain")) {
    source.TakeAll(node);
    const std::string name = source.Required(node, "name"), material = source.Required(node, "mat");
    if (!name.empty() && !model.mesh.part_names.contains(name)) {
      source.Fail(node, "there is no part " + Quoted(name), "it must be the name of an Elements section");
    }
    const auto part = parts.find(name);
    seen.insert(name);
    if (!material.empty()) materials.Assign(material, node, part == parts.end() ? nullptr : part->second);
    const std::string_view kind = node.attribute("type").value();
    if (!kind.empty() && kind != "elastic-solid") {
      source.Tell(Notice::Kind::kSetting, node, "fascicle's own elements replace " + Quoted(kind));
    }
  }
  for (Part& part : model.mesh.parts) {
    if (seen.contains(part.name)) continue;
    const std::string material = part.node.attribute("mat").value();
    if (!material.empty()) {
      materials.Assign(material, part.node, &part);
    } else {
      source.Fail(part.node, "no SolidDomain gives this part a material", "add one with its name to MeshDomains");
    }
  }
}

}  // namespace fascicle::client
