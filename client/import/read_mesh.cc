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
  std::size_t count;
};
constexpr ShapeName kShapes[] = {{"tet4", Shape::kTet4, 4},
                                 {"tet10", Shape::kTet10, 10},
                                 {"hex8", Shape::kHex8, 8},
                                 {"penta6", Shape::kPenta6, 6},
                                 {"pyra5", Shape::kPyra5, 5}};

// Solid elements whose omission would leave a hole in the body, as opposed to elements without volume.
bool IsOtherSolid(std::string_view type) {
  return type.starts_with("tet") || type.starts_with("hex") || type.starts_with("penta") || type.starts_with("pyra");
}

class MeshReader {
 public:
  MeshReader(XmlSource& source, Mesh& mesh, bool needs_names)
      : source_(source), mesh_(mesh), needs_names_(needs_names) {}

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
    if (mesh_.parts.empty()) source_.Fail(section, "has no elements", "is the file complete?");
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

  void ReadElements(pugi::xml_node section) {
    source_.TakeAll(section);
    Part part;
    part.name = section.attribute("name").value();
    if (part.name.empty() && !needs_names_) part.name = "part " + std::to_string(mesh_.parts.size() + 1);
    if (part.name.empty()) source_.Required(section, "name");
    part.node = section;
    part.type = source_.Required(section, "type");
    part.shape = IsOtherSolid(part.type) ? Shape::kOtherSolid : Shape::kNoVolume;
    part.count = 0;  // as many as the first element has
    for (const auto& [name, shape, count] : kShapes) {
      if (name != part.type) continue;
      part.shape = shape;
      part.count = count;
    }
    if (!part.name.empty() && !mesh_.part_index.try_emplace(part.name, mesh_.parts.size()).second) {
      source_.Fail(section, "there is a part " + Quoted(part.name) + " already", "name the parts uniquely");
    }
    bool empty = true;
    for (const pugi::xml_node node : section.children()) {
      if (node.type() != pugi::node_element) continue;
      ReadElement(node, part);
      empty = false;
    }
    if (empty) source_.Fail(section, "has no elements", "is the file complete?");
    mesh_.parts.push_back(std::move(part));
  }

  void ReadElement(pugi::xml_node node, Part& part) {
    const std::string_view name = node.name();
    if (name != "elem" && name != "e")
      return source_.Fail(node, "is not an element", "write <elem id=\"...\">n1,n2,...");
    const auto id = source_.IntegerAttribute(node, "id");
    const auto numbers = source_.Integers(node, part.count);
    if (!id || !numbers || numbers->empty()) return;
    part.count = numbers->size();
    const std::pair place(static_cast<std::int32_t>(mesh_.parts.size()), static_cast<std::int32_t>(part.size()));
    if (!mesh_.element_index.try_emplace(*id, place).second) {
      return source_.Fail(node, "element " + std::to_string(*id) + " is given twice", "number the elements uniquely");
    }
    auto sorted = *numbers;
    std::sort(sorted.begin(), sorted.end());
    if (part.shape != Shape::kNoVolume && std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) {
      return source_.Fail(node, "has a node twice", "mesh the body again");
    }
    std::vector<std::int32_t> indices;
    for (const std::int64_t number : *numbers) {
      indices.push_back(Find(number, node));
      if (indices.back() < 0) return;
    }
    part.ids.push_back(*id);
    part.nodes.insert(part.nodes.end(), indices.begin(), indices.end());
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
    std::size_t skipped = 0;
    for (const std::int64_t id : *numbers) {
      const auto found = mesh_.element_index.find(id);
      if (found == mesh_.element_index.end()) {
        source_.Fail(node, "refers to element " + std::to_string(id) + ", which does not exist",
                     "is the file complete?");
        break;
      }
      const auto part = static_cast<std::size_t>(found->second.first);
      skipped += part < mesh_.parts.size() && mesh_.parts[part].shape == Shape::kNoVolume ? 1 : 0;
    }
    if (skipped > 0) {
      source_.Remark(Notice::Kind::kNote, node,
                     std::to_string(skipped) + " of its " + std::to_string(numbers->size()) +
                         " elements are shells or beams, which are skipped");
    }
    if (!mesh_.element_sets.try_emplace(name, std::move(*numbers)).second) {
      source_.Fail(node, "there is an element set " + Quoted(name) + " already", "name the sets uniquely");
    }
  }

  XmlSource& source_;
  Mesh& mesh_;
  bool needs_names_;
  bool any_unnumbered_ = false;  // nodes without a number
};

// Assigns materials to parts.
class MaterialAssignment {
 public:
  MaterialAssignment(Model& model, XmlSource& source) : model_(model), source_(source) {}

  void Assign(const std::string& name, pugi::xml_node node, Part& part) {
    const auto found = FindMaterial(model_, name);
    if (!found) {
      source_.Fail(node, "there is no material " + Quoted(name), "materials of the model: " + Names());
      for (ImportedMaterial& material : model_.materials) material.used = true;  // so that they are checked, too
    } else if (model_.materials[*found].rigid) {
      part.rigid = static_cast<std::int32_t>(*found);
    } else {
      part.material = static_cast<std::int32_t>(*found);
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

  Model& model_;
  XmlSource& source_;
};

// Takes the material from deformable parts that are not tetrahedra, and reports them. Models of hexahedra only keep
// them, unless they are to be split.
void DropOtherShapes(bool split_hexahedra, XmlSource& source, Model& model) {
  model.of_hexahedra =
      !split_hexahedra && std::all_of(model.mesh.parts.begin(), model.mesh.parts.end(), [](const Part& part) {
        return part.material < 0 || part.shape == Shape::kNoVolume || part.shape == Shape::kHex8;
      });
  for (Part& part : model.mesh.parts) {
    if (part.material < 0) continue;
    if (part.shape != Shape::kNoVolume) model.materials[static_cast<std::size_t>(part.material)].used = true;
    if (!IsUsable(part, split_hexahedra || model.of_hexahedra, source)) part.material = -1;
  }
}

}  // namespace

bool IsUsable(const Part& part, bool takes_hexahedra, XmlSource& source) {
  switch (part.shape) {
    case Shape::kTet4:
    case Shape::kTet10:
      return true;
    case Shape::kHex8:
    case Shape::kPenta6:
    case Shape::kPyra5:
      if (takes_hexahedra) return true;
      source.Fail(part.node,
                  "consists of " + Quoted(part.type) + " elements; a model must have tetrahedra or hex8 only",
                  "--split-hexahedra splits them, or mesh the body with tet4 or tet10");
      return false;
    case Shape::kOtherSolid:
      source.Fail(part.node, "consists of " + Quoted(part.type) + " elements, which are not supported",
                  "mesh the body with tet4 or tet10");
      return false;
    case Shape::kNoVolume:
      source.Remark(Notice::Kind::kNotTaken, part.node,
                    "elements of type " + Quoted(part.type) + " have no volume, and are left out",
                    "mesh the body with solid elements, or remove the part");
      return false;
  }
  return false;
}

std::optional<std::size_t> FindMaterial(const Model& model, const std::string& name) {
  const auto found = model.material_index.find(name);
  return found == model.material_index.end() ? std::nullopt : std::optional(found->second);
}

const std::vector<std::int64_t>* FindElements(const Mesh& mesh, const std::string& name) {
  if (const auto set = mesh.element_sets.find(name); set != mesh.element_sets.end()) return &set->second;
  const auto part = mesh.part_index.find(name);
  return part == mesh.part_index.end() ? nullptr : &mesh.parts[part->second].ids;
}

void ReadMesh(pugi::xml_node section, XmlSource& source, Model& model) {
  const bool needs_names = model.version != "2.5";
  MeshReader(source, model.mesh, needs_names).Read(section);
}

void ReadMeshDomains(pugi::xml_node section, bool split_hexahedra, XmlSource& source, Model& model) {
  source.Take(section);
  MaterialAssignment materials(model, source);
  std::set<std::string> seen;
  for (const pugi::xml_node node : section.children()) {
    const std::string_view kind = node.name();
    if (kind != "SolidDomain" && kind != "ShellDomain" && kind != "BeamDomain") continue;
    source.TakeAll(node);
    const std::string name = source.Required(node, "name"), material = source.Required(node, "mat");
    const auto part = model.mesh.part_index.find(name);
    if (!name.empty() && part == model.mesh.part_index.end()) {
      source.Fail(node, "there is no part " + Quoted(name), "it must be the name of an Elements section");
    }
    seen.insert(name);
    if (!material.empty() && part != model.mesh.part_index.end()) {
      materials.Assign(material, node, model.mesh.parts[part->second]);
    }
    const std::string_view type = node.attribute("type").value();
    if (kind == "SolidDomain" && !type.empty() && type != "elastic-solid") {
      source.Remark(Notice::Kind::kNote, node, "fascicle's own elements replace " + Quoted(type));
    }
  }
  for (Part& part : model.mesh.parts) {
    if (seen.contains(part.name)) continue;
    const std::string material = part.node.attribute("mat").value();
    if (!material.empty()) {
      materials.Assign(material, part.node, part);
    } else if (part.shape != Shape::kNoVolume) {
      source.Fail(part.node, "no SolidDomain gives this part a material", "add one with its name to MeshDomains");
    }
  }
  DropOtherShapes(split_hexahedra, source, model);
}

}  // namespace fascicle::client
