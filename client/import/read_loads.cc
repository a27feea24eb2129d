// <Loads>: nodal forces, tractions, pressures, body forces [FEBio User Manual, 3.13; 2.9, 3.10].
#include <cmath>
#include <string_view>

#include "client/import/sections.h"
#include "core/geometry/text_scanner.h"

namespace fascicle::client {
namespace {

class LoadReader {
 public:
  LoadReader(XmlSource& source, Model& model) : source_(source), model_(model) {}

  void Read(pugi::xml_node node) {
    const std::string_view element = node.name();
    // Version 3 need not give the type of a nodal load.
    const bool needs_type = element == "surface_load" || element == "body_load";
    const std::string type =
        needs_type ? source_.Required(node, "type") : node.attribute("type").as_string("nodal_load");
    if (type.empty()) return;
    if (element == "nodal_load" && type == "nodal_load") {
      ReadNodalLoad(node);
    } else if (element == "nodal_load" && type == "nodal_force") {
      ReadNodalForce(node);
    } else if (element == "surface_load" && type == "traction") {
      ReadTraction(node);
    } else if (element == "surface_load" && type == "pressure") {
      ReadPressure(node);
    } else if (element == "body_load" && type == "const") {
      ReadConstantForce(node);
    } else if (element == "body_load" && type == "body force") {
      ReadBodyForce(node);
    } else {
      source_.Tell(Notice::Kind::kNotTaken, node, "loads of type " + Quoted(type) + " are not supported",
                   "write it as nodal forces, a traction or a body force, or remove it");
    }
  }

 private:
  // Version 2.5 has the direction as the attribute bc.
  void ReadNodalLoad(pugi::xml_node node) {
    source_.Take(node);
    NodalForces forces;
    forces.node = node;
    forces.set = source_.Required(node, "node_set");
    const pugi::xml_node dof = node.child("dof");
    const std::string name = dof ? source_.Text(dof) : std::string(node.attribute("bc").value());
    const std::size_t axis = std::string_view("xyz").find(name.size() == 1 ? name[0] : '?');
    if (axis == std::string_view::npos) {
      return source_.Fail(dof ? dof : node, Quoted(name) + " is not a direction", "<dof> must be x, y or z");
    }
    pugi::xml_node scale = node.child("scale");
    if (!scale) scale = node.child("value");
    if (!scale) return source_.Fail(node, "has no scale", "give <scale lc=\"...\">, the force on each node");
    const Driven force = source_.DrivenNumber(scale);
    forces.each[static_cast<Eigen::Index>(axis)] = force.value;
    forces.controller = force.controller;
    if (!forces.set.empty()) model_.nodal_forces.push_back(std::move(forces));
  }

  // A vector with an optional load controller.
  std::optional<Vec3> DrivenVector(pugi::xml_node node, std::optional<std::int64_t>& controller) {
    if (!source_.IsConstant(node)) return std::nullopt;
    if (node.attribute("lc")) {
      const auto number = source_.IntegerAttribute(node, "lc");
      if (number && *number > 0) controller = number;
    }
    return source_.Vector(node);
  }

  void ReadNodalForce(pugi::xml_node node) {
    source_.Take(node);
    NodalForces forces;
    forces.node = node;
    forces.set = source_.Required(node, "node_set");
    const pugi::xml_node value = node.child("value");
    if (!value) return source_.Fail(node, "has no value", "give <value>x,y,z</value>, the force on each node");
    const auto vector = DrivenVector(value, forces.controller);
    if (!vector || forces.set.empty()) return;
    forces.each = *vector;
    model_.nodal_forces.push_back(std::move(forces));
  }

  void ReadTraction(pugi::xml_node node) {
    source_.Take(node);
    SurfaceLoad load;
    load.node = node;
    load.surface = source_.Required(node, "surface");
    Driven scale;
    scale.value = 1;
    if (const pugi::xml_node child = node.child("scale")) scale = Mapped(child, load);
    load.controller = scale.controller;
    const pugi::xml_node traction = node.child("traction");
    if (!traction) return source_.Fail(node, "has no traction", "give <traction>x,y,z</traction>");
    std::optional<std::int64_t> ignored;
    const auto vector = DrivenVector(traction, ignored);
    if (ignored)
      source_.Remark(Notice::Kind::kNote, traction, "its lc is ignored, as in FEBio: that of <scale> applies");
    if (!IsLinear(node) && vector) {
      source_.Remark(Notice::Kind::kChanged, traction,
                     "acts per rest area; FEBio's grows with the surface, unless <linear> is 1",
                     "set <linear> to 1 if the total force should not grow");
    }
    if (!vector || load.surface.empty()) return;
    load.traction = scale.value * *vector;
    if (!Finite(load)) return;
    model_.surface_loads.push_back(std::move(load));
  }

  // A number, or a map of numbers of the load's surface, or a formula of one: the number is 1 then, with factors.
  Driven Mapped(pugi::xml_node node, SurfaceLoad& load) {
    const std::string_view type = node.attribute("type").value();
    if (type != "map" && type != "math") return source_.DrivenNumber(node);
    const std::string text = source_.MathText(node);
    for (const auto& [name, map] : model_.surface_maps) {
      std::string mistake;
      const auto formula = Expression::Parse(text, name, mistake);
      if (!formula || map.surface != load.surface || Expression::Parse(text, "", mistake)) continue;
      for (const double value : map.values) load.factors.push_back(formula->At(value));
      Driven driven;
      driven.node = node;
      driven.value = 1;
      if (node.attribute("lc")) driven.controller = source_.IntegerAttribute(node, "lc");
      if (driven.controller && *driven.controller <= 0) driven.controller.reset();
      return driven;
    }
    return source_.DrivenNumber(node);
  }

  // Whether a surface load refers to the rest shape.
  bool IsLinear(pugi::xml_node node) {
    const pugi::xml_node linear = node.child("linear");
    return linear && source_.Flag(linear);
  }

  void ReadPressure(pugi::xml_node node) {
    source_.Take(node);
    SurfaceLoad load;
    load.node = node;
    load.surface = source_.Required(node, "surface");
    const pugi::xml_node child = node.child("pressure");
    if (!child) return source_.Fail(node, "has no pressure", "give <pressure lc=\"...\">");
    const Driven pressure = Mapped(child, load);
    load.pressure = pressure.value;
    load.controller = pressure.controller;
    for (const char* name : {"symmetric_stiffness", "scale"}) {
      const pugi::xml_node other = node.child(name);
      if (other && std::string_view(name) == "symmetric_stiffness") source_.TakeAll(other);
    }
    load.follows = !IsLinear(node);
    if (!load.surface.empty() && Finite(load)) model_.surface_loads.push_back(std::move(load));
  }

  bool Finite(const SurfaceLoad& load) {
    for (const double factor : load.factors) {
      if (std::isfinite(factor)) continue;
      source_.Fail(load.node, "is not finite on every facet", "correct its formula or map");
      return false;
    }
    return true;
  }

  // FEBio's solver applies a body force b as -density b, so that 9.81 along z pulls down.
  void AddBodyForce(const Vec3& force, std::optional<std::int64_t> controller, pugi::xml_node node) {
    if (force.isZero(0)) return;
    model_.body_forces.push_back({-force, controller, node});
    source_.Remark(Notice::Kind::kNote, node, "acts against the vector that is given, as in FEBio's solver");
  }

  bool ActsEverywhere(pugi::xml_node node) {
    if (!node.attribute("elem_set")) return true;
    source_.Tell(Notice::Kind::kNotTaken, node, "a body force on a part of the model; gravity acts on all of it",
                 "remove elem_set, or the load");
    return false;
  }

  void ReadConstantForce(pugi::xml_node node) {
    if (!ActsEverywhere(node)) return;
    source_.Take(node);
    for (const auto& [name, axis] : {std::pair("x", 0), std::pair("y", 1), std::pair("z", 2)}) {
      const pugi::xml_node child = node.child(name);
      if (!child) continue;
      const Driven component = source_.DrivenNumber(child);
      Vec3 force = Vec3::Zero();
      force[axis] = component.value;
      AddBodyForce(force, component.controller, child);
    }
  }

  void ReadBodyForce(pugi::xml_node node) {
    if (!ActsEverywhere(node)) return;
    source_.Take(node);
    const pugi::xml_node child = node.child("force");
    if (!child) return source_.Fail(node, "has no force", "give <force>x,y,z</force>");
    std::optional<std::int64_t> controller;
    if (const auto force = DrivenVector(child, controller)) AddBodyForce(*force, controller, node);
  }

  XmlSource& source_;
  Model& model_;
};

}  // namespace

void ReadLoads(pugi::xml_node section, XmlSource& source, Model& model) {
  source.Take(section);
  LoadReader reader(source, model);
  for (const pugi::xml_node node : section.children()) {
    const std::string_view name = node.name();
    if (name == "nodal_load" || name == "surface_load" || name == "body_load") reader.Read(node);
  }
}

}  // namespace fascicle::client
