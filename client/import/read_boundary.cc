// <Boundary>: fixed and moved node sets, and those attached to rigid bodies [FEBio User Manual, 3.11; 2.9, 3.9].
// Version 3 has `fix` and `prescribe` for `zero displacement` and `prescribed displacement`, version 2.5 elements of
// these names.
#include <string_view>

#include "client/import/sections.h"
#include "core/geometry/text_scanner.h"

namespace fascicle::client {
namespace {

// 0, 1, 2 for x, y, z; -1 otherwise.
int AxisNamed(std::string_view name) { return name == "x" ? 0 : name == "y" ? 1 : name == "z" ? 2 : -1; }

// Degrees of freedom of shells, which nodes of solids lack.
bool IsOfShell(std::string_view name) {
  for (const char* known : {"u", "v", "w", "sx", "sy", "sz"}) {
    if (name == known) return true;
  }
  return false;
}

class BoundaryReader {
 public:
  BoundaryReader(XmlSource& source, Model& model) : source_(source), model_(model) {}

  void Read(pugi::xml_node node) {
    const std::string_view element = node.name();
    if (element == "bc") {
      ReadTyped(node);
    } else if (element == "rigid_body") {
      ReadRigidBody(node, source_, model_);
    } else if (element == "fix") {
      source_.Take(node);
      FixListed(node, node, source_.Required(node, "node_set"), source_.WordsOf(node.attribute("bc").value()));
    } else if (element == "prescribe") {
      source_.Take(node);
      const std::string bc = source_.Required(node, "bc");
      if (!bc.empty()) Prescribe(node, node, bc);
    } else if (element == "rigid") {
      source_.Take(node);
      Attach(node, source_.Required(node, "rb"), node);
    }
  }

 private:
  void ReadTyped(pugi::xml_node node) {
    const std::string type = source_.Required(node, "type");
    if (type.empty()) return;
    if (type == "zero displacement" || type == "fix") {
      source_.Take(node);
      ReadFixed(node);
    } else if (type == "prescribed displacement" || type == "prescribe") {
      source_.Take(node);
      const pugi::xml_node dof = node.child("dof");
      Prescribe(node, dof ? dof : node, dof ? source_.Text(dof) : std::string());
    } else if (type == "rigid") {
      source_.TakeAll(node);  // how shells are attached does not matter
      const pugi::xml_node rb = node.child("rb");
      if (!rb) return source_.Fail(node, "has no rb", "give <rb>, the name of the rigid body's material");
      Attach(node, source_.Text(rb), rb);
    } else if (type == "zero shell displacement" || type == "zero rotation") {
      source_.Tell(Notice::Kind::kNote, node, "holds shells; nodes of solids have no such motion");
    } else {
      source_.Tell(Notice::Kind::kNotTaken, node, "boundary conditions of type " + Quoted(type) + " are not supported",
                   "write it as a prescribed displacement, or remove it");
    }
  }

  void ReadFixed(pugi::xml_node node) {
    const std::string set = source_.Required(node, "node_set");
    std::vector<std::string> names;
    for (const char* name : {"x", "y", "z"}) {
      const pugi::xml_node child = node.child((std::string(name) + "_dof").c_str());
      if (child && source_.Flag(child)) names.push_back(name);
    }
    const pugi::xml_node list = node.child("dofs");
    if (list) {
      for (std::string& name : source_.Words(list)) names.push_back(std::move(name));
    }
    FixListed(node, list ? list : node, set, names);
  }

  void FixListed(pugi::xml_node node, pugi::xml_node list, const std::string& set,
                 const std::vector<std::string>& names) {
    if (names.empty()) return source_.Fail(node, "contains no direction", "set x_dof, y_dof or z_dof to 1");
    for (const std::string& name : names) {
      const int axis = AxisNamed(name);
      if (axis >= 0 && !set.empty()) model_.supports.push_back({set, axis, std::nullopt, node});
      if (axis < 0 && IsOfShell(name)) {
        source_.Remark(Notice::Kind::kNote, list, Quoted(name) + " is a motion of shells, which solids lack");
      } else if (axis < 0) {
        source_.Fail(list, Quoted(name) + " is not a direction of a solid's node", "fascicle has x, y and z");
      }
    }
  }

  void Prescribe(pugi::xml_node node, pugi::xml_node dof, const std::string& name) {
    const std::string set = source_.Required(node, "node_set");
    const int axis = AxisNamed(name);
    if (axis < 0) source_.Fail(dof, Quoted(name) + " is not a direction", "it must be x, y or z");
    pugi::xml_node value = node.child("value");
    if (!value || value.attribute("node_data")) value = node.child("scale");
    if (!value) return source_.Fail(node, "has no value", "give <value lc=\"...\">");
    const Driven motion = source_.DrivenNumber(value);
    if (const pugi::xml_node relative = node.child("relative"); relative && source_.Flag(relative)) {
      source_.Tell(Notice::Kind::kNote, relative, "in the first step, relative and absolute motions are the same");
    }
    if (!set.empty() && axis >= 0) model_.supports.push_back({set, axis, motion, node});
  }

  void Attach(pugi::xml_node node, const std::string& name, pugi::xml_node named) {
    const std::string set = source_.Required(node, "node_set");
    if (name.empty()) return source_.Fail(named, "names no rigid body", "give the name of its material");
    RigidBody* body = FindRigid(name, named, source_, model_);
    if (body != nullptr && !set.empty()) body->sets.push_back({set, node});
  }

  XmlSource& source_;
  Model& model_;
};

}  // namespace

void ReadBoundary(pugi::xml_node section, XmlSource& source, Model& model) {
  source.Take(section);
  BoundaryReader reader(source, model);
  for (const pugi::xml_node node : section.children()) reader.Read(node);
}

}  // namespace fascicle::client
