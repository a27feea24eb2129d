// <Boundary>: fixed and moved node sets [FEBio User Manual, 3.11]. Version 3 has `fix` and `prescribe` for `zero
// displacement` and `prescribed displacement`.
#include <string_view>

#include "client/import/sections.h"
#include "core/geometry/text_scanner.h"

namespace fascicle::client {
namespace {

// 0, 1, 2 for x, y, z; -1 otherwise.
int AxisNamed(std::string_view name) { return name == "x" ? 0 : name == "y" ? 1 : name == "z" ? 2 : -1; }

void ReadFixed(pugi::xml_node node, XmlSource& source, Model& model) {
  const std::string set = source.Required(node, "node_set");
  bool any = false;
  const auto fix = [&](int axis) {
    any = true;
    if (!set.empty()) model.supports.push_back({set, axis, std::nullopt, node});
  };
  for (const auto& [name, axis] : {std::pair("x_dof", 0), std::pair("y_dof", 1), std::pair("z_dof", 2)}) {
    const pugi::xml_node child = node.child(name);
    if (child && source.Flag(child)) fix(axis);
  }
  if (const pugi::xml_node list = node.child("dofs")) {
    std::string text = source.Text(list) + ",";
    for (std::size_t begin = 0, end; (end = text.find(',', begin)) != std::string::npos; begin = end + 1) {
      std::string name = text.substr(begin, end - begin);
      std::erase(name, ' ');
      const int axis = AxisNamed(name);
      if (axis >= 0) {
        fix(axis);
      } else if (!name.empty()) {
        source.Fail(list, Quoted(name) + " is not a direction of a solid's node", "fascicle has x, y and z");
      }
    }
  }
  if (!any) source.Fail(node, "contains no direction", "set x_dof, y_dof or z_dof to 1");
}

void ReadPrescribed(pugi::xml_node node, XmlSource& source, Model& model) {
  const std::string set = source.Required(node, "node_set");
  const pugi::xml_node dof = node.child("dof");
  const std::string name = dof ? source.Text(dof) : std::string();
  const int axis = AxisNamed(name);
  if (axis < 0) source.Fail(dof ? dof : node, Quoted(name) + " is not a direction", "<dof> must be x, y or z");
  pugi::xml_node value = node.child("value");
  if (!value) value = node.child("scale");
  if (!value) return source.Fail(node, "has no value", "give <value lc=\"...\">");
  const Driven motion = source.DrivenNumber(value);
  if (const pugi::xml_node relative = node.child("relative"); relative && source.Flag(relative)) {
    source.Tell(Notice::Kind::kSetting, relative, "in the first step, relative and absolute motions are the same");
  }
  if (!set.empty() && axis >= 0) model.supports.push_back({set, axis, motion, node});
}

}  // namespace

void ReadBoundary(pugi::xml_node section, XmlSource& source, Model& model) {
  source.Take(section);
  for (const pugi::xml_node node : section.children("bc")) {
    const std::string type = source.Required(node, "type");
    if (type.empty()) continue;
    if (type == "zero displacement" || type == "fix") {
      source.Take(node);
      ReadFixed(node, source, model);
    } else if (type == "prescribed displacement" || type == "prescribe") {
      source.Take(node);
      ReadPrescribed(node, source, model);
    } else {
      source.Tell(Notice::Kind::kNotTaken, node, "boundary conditions of type " + Quoted(type) + " are not supported");
    }
  }
}

}  // namespace fascicle::client
