// Rigid bodies: <Rigid>, and <rigid_body> of version 2.5 [FEBio User Manual, 3.12; 2.9, 3.9.2].
#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>
#include <string_view>

#include "client/import/body_draft.h"
#include "client/import/sections.h"
#include "client/import/tetrahedra.h"
#include "core/geometry/solid_cells.h"
#include "core/geometry/text_scanner.h"

namespace fascicle::client {
namespace {

constexpr const char* kMotionNames[] = {"along x", "along y", "along z", "about x", "about y", "about z"};

// A degree of freedom by its name: x, y, z; Rx, Ry, Rz, which are displacements since version 3 and rotations before;
// Ru, Rv, Rw. -1 for other names.
int MotionNamed(std::string_view name, bool is_version_2) {
  constexpr std::string_view kOld[] = {"x", "y", "z", "Rx", "Ry", "Rz"};
  constexpr std::string_view kNew[] = {"Rx", "Ry", "Rz", "Ru", "Rv", "Rw"};
  for (int k = 0; k < 6; ++k) {
    if (name == (is_version_2 ? kOld : kNew)[k] || (k < 3 && name == kOld[k])) return k;
  }
  return -1;
}

class RigidReader {
 public:
  RigidReader(XmlSource& source, Model& model) : source_(source), model_(model) {}

  void Read(pugi::xml_node node) {
    const std::string_view element = node.name();
    const std::string type = source_.Required(node, "type");
    if (type.empty()) return;
    if (element == "rigid_connector") {
      source_.Tell(Notice::Kind::kNotTaken, node, "rigid connectors are not supported",
                   "remove it, or prescribe all six motions of its bodies");
      return;
    }
    source_.Take(node);
    RigidBody* body = BodyOf(node);
    if (body == nullptr) return source_.TakeAll(node);
    if (type == "rigid_fixed" || type == "fix") {
      ReadFixed(node, *body);
    } else if (type == "rigid_displacement" || type == "rigid_rotation" || type == "prescribe" ||
               type == "rigid_prescribed") {
      ReadPrescribed(node, *body);
    } else if (type == "rigid_rotation_vector") {
      ReadRotationVector(node, *body);
    } else if (IsForce(element, type)) {
      source_.TakeAll(node);
      body->forces.push_back(node);
    } else {
      source_.Tell(Notice::Kind::kNotTaken, node, "the rigid constraint " + Quoted(type) + " is not supported",
                   "write rigid_fixed, rigid_displacement and rigid_rotation");
    }
  }

 private:
  // Version 3 has loads and initial velocities among the constraints.
  static bool IsForce(std::string_view element, const std::string& type) {
    return element == "rigid_load" || element == "rigid_ic" || type == "force" || type.starts_with("initial");
  }

  RigidBody* BodyOf(pugi::xml_node node) {
    const pugi::xml_node rb = node.child("rb");
    const std::string name = rb ? source_.Text(rb) : std::string();
    if (!name.empty()) return FindRigid(name, rb, source_, model_);
    source_.Fail(node, "has no rb", "give <rb>, the name of the rigid body's material");
    return nullptr;
  }

  void ReadFixed(pugi::xml_node node, RigidBody& body) {
    for (const char* name : {"Rx", "Ry", "Rz", "Ru", "Rv", "Rw", "x", "y", "z"}) {
      const pugi::xml_node child = node.child((std::string(name) + "_dof").c_str());
      if (child && source_.Flag(child)) HoldRigid(body, MotionNamed(name, false), std::nullopt, node, source_);
    }
    const pugi::xml_node list = node.child("dofs");
    if (!list) return;
    for (const std::string& name : source_.Words(list)) {
      const int motion = MotionNamed(name, false);
      if (motion < 0) source_.Fail(list, Quoted(name) + " is no motion", "write Rx, Ry, Rz, Ru, Rv or Rw");
      if (motion >= 0) HoldRigid(body, motion, std::nullopt, node, source_);
    }
  }

  void ReadPrescribed(pugi::xml_node node, RigidBody& body) {
    const pugi::xml_node dof = node.child("dof"), value = node.child("value");
    const std::string name = dof ? source_.Text(dof) : std::string();
    const int motion = MotionNamed(name, false);
    if (motion < 0) {
      return source_.Fail(dof ? dof : node, Quoted(name) + " is no motion", "<dof> must be Rx, Ry, Rz, Ru, Rv or Rw");
    }
    if (!value) return source_.Fail(node, "has no value", "give <value lc=\"...\">");
    // In the first step, relative and absolute motions are the same.
    if (const pugi::xml_node relative = node.child("relative")) source_.Flag(relative);
    HoldRigid(body, motion, source_.DrivenNumber(value), node, source_);
  }

  void ReadRotationVector(pugi::xml_node node, RigidBody& body) {
    int motion = 3;
    for (const char* name : {"vx", "vy", "vz"}) {
      const pugi::xml_node child = node.child(name);
      const auto driven = child ? std::optional(source_.DrivenNumber(child)) : std::nullopt;
      HoldRigid(body, motion++, driven, node, source_);
    }
  }

  XmlSource& source_;
  Model& model_;
};

// The volume and the first moment of elements; of shells, their area.
struct Moments {
  double size = 0;
  Vec3 first = Vec3::Zero();
  Vec3 centre() const { return first / size; }
};

// Corners of the solid that an element of more nodes has.
SolidShape CornerShape(const Part& part) {
  if (part.type.starts_with("hex")) return SolidShape::kHexahedron;
  return part.type.starts_with("penta") ? SolidShape::kWedge : SolidShape::kPyramid;
}

void AddElement(const Mesh& mesh, const Part& part, std::size_t e, Moments& moments) {
  const std::span<const std::int32_t> nodes(part.nodes.data() + e * part.count, part.count);
  const auto x = [&](std::int32_t n) { return mesh.nodes[static_cast<std::size_t>(n)]; };
  const auto add = [&](double size, const Vec3& centre) {
    moments.size += size;
    moments.first += size * centre;
  };
  if (part.shape == Shape::kNoVolume) {
    for (std::size_t k = 2; k < std::min<std::size_t>(part.count, part.type.starts_with("tri") ? 3 : 4); ++k) {
      const Vec3 a = x(nodes[0]), b = x(nodes[k - 1]), c = x(nodes[k]);
      add(0.5 * (b - a).cross(c - a).norm(), (a + b + c) / 3);
    }
    return;
  }
  std::vector<Tetrahedron> tetrahedra;
  if (part.type.starts_with("tet")) {
    if (part.count >= 4) tetrahedra.push_back({nodes[0], nodes[1], nodes[2], nodes[3]});
  } else {
    const SolidShape shape = CornerShape(part);
    const auto corners = static_cast<std::size_t>(CornersOf(shape));
    if (part.count >= corners) SplitSolid(shape, nodes.first(corners), tetrahedra);
  }
  for (const Tetrahedron& t : tetrahedra) {
    const Vec3 a = x(t[0]), b = x(t[1]), c = x(t[2]), d = x(t[3]);
    add(std::abs((b - a).cross(c - a).dot(d - a)) / 6, 0.25 * (a + b + c + d));
  }
}

// Turns rigid bodies into supports.
class RigidHolder {
 public:
  RigidHolder(XmlSource& source, Model& model)
      : source_(source), model_(model), node_sets_(model.mesh, source), deformable_(model.mesh.nodes.size(), 0) {
    for (const Part& part : model.mesh.parts) {
      if (part.material < 0) continue;
      for (const std::int32_t n : part.nodes) deformable_[static_cast<std::size_t>(n)] = 1;
    }
  }

  void Hold(std::int32_t m) {
    const ImportedMaterial& material = model_.materials[static_cast<std::size_t>(m)];
    const auto found = model_.rigid_bodies.find(m);
    const RigidBody body = found == model_.rigid_bodies.end() ? RigidBody() : found->second;
    const std::vector<std::int32_t> nodes = NodesOf(m, body);
    if (nodes.empty()) {
      source_.Remark(Notice::Kind::kNote, material.node, "a rigid body that holds no node of a deformable part");
      return;
    }
    if (const std::string free = FreeMotions(body); !free.empty())
      return TellOfFree(material, body, free, nodes.size());
    for (const pugi::xml_node force : body.forces) {
      source_.Remark(Notice::Kind::kNote, force, "acts on a rigid body whose motion is given, and changes nothing");
    }
    AddSupports(m, material, body, nodes);
  }

 private:
  // The nodes of deformable parts that the body holds.
  std::vector<std::int32_t> NodesOf(std::int32_t m, const RigidBody& body) {
    std::vector<std::int32_t> nodes;
    const auto add = [&](const std::vector<std::int32_t>& from) {
      std::copy_if(from.begin(), from.end(), std::back_inserter(nodes),
                   [&](std::int32_t n) { return deformable_[static_cast<std::size_t>(n)] != 0; });
    };
    for (const Part& part : model_.mesh.parts) {
      if (part.rigid == m) add(part.nodes);
    }
    for (const auto& [set, node] : body.sets) {
      if (const auto* of_set = node_sets_.Find(set, node)) add(*of_set);
    }
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    return nodes;
  }

  static std::string FreeMotions(const RigidBody& body) {
    std::string free;
    for (std::size_t k = 0; k < 6; ++k) {
      if (!body.motions[k].held) free += (free.empty() ? "" : ", ") + std::string(kMotionNames[k]);
    }
    return free;
  }

  void TellOfFree(const ImportedMaterial& material, const RigidBody& body, const std::string& free, std::size_t count) {
    source_.Remark(Notice::Kind::kNotTaken, material.node,
                   "the rigid body moves freely " + free + "; a support has given motions only: its " +
                       std::to_string(count) + " nodes of deformable parts are free",
                   "fix or prescribe all six motions, or give the part a stiff material");
    for (const pugi::xml_node force : body.forces) {
      source_.Remark(Notice::Kind::kNotTaken, force, "acts on a rigid body that moves freely", "remove it");
    }
  }

  void AddSupports(std::int32_t m, const ImportedMaterial& material, const RigidBody& body,
                   const std::vector<std::int32_t>& nodes) {
    std::int32_t rotation = -1;
    if (!Rotation(m, material, body, rotation)) return;
    const std::string set = "@rigid:" + material.name;
    model_.mesh.node_sets[set] = {nodes, material.node};
    for (int axis = 0; axis < 3; ++axis) {
      const RigidMotion& motion = body.motions[static_cast<std::size_t>(axis)];
      model_.supports.push_back({set, axis, motion.motion, motion.node, rotation});
    }
  }

  // Sets the index of the body's rotation, which is about one line. False if there is no such line.
  bool Rotation(std::int32_t m, const ImportedMaterial& material, const RigidBody& body, std::int32_t& rotation) {
    const RigidMotion* first = nullptr;
    Vec3 vector = Vec3::Zero();
    for (int axis = 0; axis < 3; ++axis) {
      const RigidMotion& motion = body.motions[static_cast<std::size_t>(3 + axis)];
      if (!motion.motion || motion.motion->value == 0) continue;
      if (first == nullptr) first = &motion;
      if (motion.motion->controller != first->motion->controller) {
        source_.Remark(Notice::Kind::kNotTaken, motion.node,
                       "turns the body about several axes by different load curves; a support turns about one line",
                       "give all rotations the same load curve");
        return false;
      }
      vector[axis] = motion.motion->value;
    }
    if (first == nullptr) return true;
    const std::optional<Vec3> centre = material.centre ? material.centre : CentreOf(m, *first);
    if (!centre) return false;
    RigidRotation made{*centre, vector.stableNormalized(), *first->motion};
    made.angle.value = vector.norm();
    rotation = static_cast<std::int32_t>(model_.rotations.size());
    model_.rotations.push_back(made);
    return true;
  }

  // The centre of mass of a body that turns, from its elements.
  std::optional<Vec3> CentreOf(std::int32_t m, const RigidMotion& motion) {
    Moments solids, shells;
    for (const Part& part : model_.mesh.parts) {
      if (part.rigid != m) continue;
      for (std::size_t e = 0; e < part.size(); ++e) {
        AddElement(model_.mesh, part, e, part.shape == Shape::kNoVolume ? shells : solids);
      }
    }
    if ((solids.size > 0) != (shells.size > 0)) return (solids.size > 0 ? solids : shells).centre();
    source_.Fail(motion.node, "turns about a centre of mass that does not follow from the elements of the body",
                 "give <center_of_mass> of its material");
    return std::nullopt;
  }

  XmlSource& source_;
  Model& model_;
  NodeSets node_sets_;
  std::vector<char> deformable_;  // of each node: whether it belongs to a deformable part
};

}  // namespace

RigidBody* FindRigid(const std::string& name, pugi::xml_node node, XmlSource& source, Model& model) {
  const auto found = FindMaterial(model, name);
  if (found && model.materials[*found].rigid) return &model.rigid_bodies[static_cast<std::int32_t>(*found)];
  source.Fail(node, "there is no rigid body " + Quoted(name), "name a material of type `rigid body`");
  return nullptr;
}

void HoldRigid(RigidBody& body, int motion, std::optional<Driven> driven, pugi::xml_node node, XmlSource& source) {
  RigidMotion& held = body.motions[static_cast<std::size_t>(motion)];
  if (driven && driven->value == 0) driven.reset();
  const bool same = held.motion.has_value() == driven.has_value() &&
                    (!driven || (driven->value == held.motion->value && driven->controller == held.motion->controller));
  if (held.held && !same) {
    return source.Fail(node,
                       "moves the rigid body " + std::string(kMotionNames[motion]) + " differently from line " +
                           std::to_string(source.LineOf(held.node)) + " does",
                       "keep one of them");
  }
  held = {true, driven, node};
}

void ReadRigidBody(pugi::xml_node node, XmlSource& source, Model& model) {
  source.Take(node);
  RigidBody* body = FindRigid(source.Required(node, "mat"), node, source, model);
  if (body == nullptr) return source.TakeAll(node);
  for (const pugi::xml_node child : node.children()) {
    if (child.type() != pugi::node_element) continue;
    source.TakeAll(child);
    const std::string_view name = child.name();
    if (name == "force" || name.starts_with("initial")) {
      body->forces.push_back(child);
      continue;
    }
    if (name != "fixed" && name != "prescribed") {
      source.Remark(Notice::Kind::kNotTaken, child, "is not supported", "write <fixed> and <prescribed>");
      continue;
    }
    const std::string bc = source.Required(child, "bc");
    const int motion = MotionNamed(bc, true);
    if (motion < 0) {
      if (!bc.empty()) source.Fail(child, Quoted(bc) + " is no motion", "write x, y, z, Rx, Ry or Rz");
      continue;
    }
    std::optional<Driven> driven;
    if (name == "prescribed") driven = source.DrivenNumber(child);
    HoldRigid(*body, motion, driven, child, source);
  }
}

void ReadRigid(pugi::xml_node section, XmlSource& source, Model& model) {
  source.Take(section);
  RigidReader reader(source, model);
  for (const pugi::xml_node node : section.children()) {
    const std::string_view name = node.name();
    if (name == "rigid_body") {
      ReadRigidBody(node, source, model);
    } else if (name.starts_with("rigid_")) {
      reader.Read(node);
    }
  }
}

void HoldRigidNodes(XmlSource& source, Model& model) {
  RigidHolder holder(source, model);
  for (std::size_t m = 0; m < model.materials.size(); ++m) {
    if (model.materials[m].rigid) holder.Hold(static_cast<std::int32_t>(m));
  }
}

}  // namespace fascicle::client
