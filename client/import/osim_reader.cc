#include "client/import/osim_reader.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <set>
#include <utility>

#include "client/import/osim_functions.h"
#include "client/import/xml_source.h"
#include "core/skeleton/placement.h"

namespace fascicle::client {
namespace {

// The last name of a path of components: "/bodyset/ulna" or "../ulna" -> "ulna".
std::string LastName(const std::string& path) { return path.substr(path.rfind('/') + 1); }

bool EndsWith(std::string_view text, std::string_view end) { return text.ends_with(end); }

constexpr int kUnknown = -2;

class OsimReader {
 public:
  OsimReader(std::string_view bytes, const std::string& name, Problems& problems) : xml_(name, bytes, problems) {}

  std::optional<OsimModel> Read() {
    const pugi::xml_node root = xml_.root();
    if (!root) return std::nullopt;
    const pugi::xml_node model = root.child("Model");
    if (std::string_view(root.name()) != "OpenSimDocument" || !model) {
      xml_.Fail(root, "is not a model of OpenSim", "its root should be <OpenSimDocument> with a <Model>");
      return std::nullopt;
    }
    xml_.Take(root);
    xml_.Take(model);
    version_ = root.attribute("Version").as_int();
    if (version_ < 30000) {
      xml_.Fail(root, "is of version " + std::to_string(version_), "open and save it with OpenSim 3 or 4");
      return std::nullopt;
    }
    skeleton_.name = model.attribute("name").value();
    if (const auto gravity = Optional(model.child("gravity"))) skeleton_.gravity = *gravity;
    ReadBones(model);
    ReadFrames(model);
    ReadJoints(model);
    SortJoints(model);
    ReadMuscles(model);
    TellOfSets(model);
    if (xml_.failures() > 0) return std::nullopt;
    return OsimModel{std::move(skeleton_), std::move(xml_.notices)};
  }

 private:
  struct Frame {
    int bone = kUnknown;
    Pose pose;  // in the bone's frame
  };

  std::optional<Vec3> Optional(pugi::xml_node node) { return node ? xml_.Vector(node) : std::nullopt; }
  Vec3 VectorOr(pugi::xml_node node, const Vec3& value) { return Optional(node).value_or(value); }
  double NumberOr(pugi::xml_node node, double value) { return node ? xml_.Number(node) : value; }
  static std::string NameOf(pugi::xml_node node) { return node.attribute("name").value(); }
  // The members of <NAMEset><objects>.
  pugi::xml_node Objects(pugi::xml_node parent, const char* set) {
    const pugi::xml_node node = parent.child(set);
    xml_.Take(node);
    const pugi::xml_node objects = node.child("objects");
    xml_.Take(objects);
    return objects;
  }

  // -1: the ground.
  int BoneOf(pugi::xml_node node, const std::string& path) {
    const std::string name = LastName(path);
    if (name == "ground") return Joint::kGround;
    const auto found = bones_.find(name);
    if (found != bones_.end()) return found->second;
    xml_.Fail(node, "there is no body \"" + name + "\"");
    return kUnknown;
  }

  void ReadBones(pugi::xml_node model) {
    for (const pugi::xml_node node : Objects(model, "BodySet").children()) {
      if (std::string_view(node.name()) != "Body") continue;
      xml_.Take(node);
      const std::string name = NameOf(node);
      if (name == "ground") {  // version 3 lists it
        ReadSurfacesOf(node, Joint::kGround);
        continue;
      }
      Bone bone;
      bone.name = name;
      bone.mass = NumberOr(node.child("mass"), 0);
      bone.mass_centre = VectorOr(node.child("mass_center"), Vec3::Zero());
      bone.inertia = InertiaOf(node);
      if (bone.mass < 0) xml_.Fail(node.child("mass"), "is negative");
      if (name.empty() || !bones_.emplace(name, static_cast<int>(skeleton_.bones.size())).second) {
        xml_.Fail(node, name.empty() ? "has no name" : "this name is given twice");
      }
      const int index = static_cast<int>(skeleton_.bones.size());
      skeleton_.bones.push_back(std::move(bone));
      ReadSurfacesOf(node, index);
    }
    const pugi::xml_node ground = model.child("Ground");
    if (ground) ReadSurfacesOf(ground, Joint::kGround);
    if (skeleton_.bones.empty()) xml_.Fail(model, "has no bodies", "give a <BodySet>");
  }

  Mat3 InertiaOf(pugi::xml_node node) {
    std::array<double, 6> c = {};  // xx, yy, zz, xy, xz, yz
    if (const pugi::xml_node all = node.child("inertia")) {
      const std::vector<double> values = NumbersOf(xml_, all);
      if (values.size() == 6) {
        std::copy(values.begin(), values.end(), c.begin());
      } else {
        xml_.Fail(all, "should have six numbers: xx, yy, zz, xy, xz, yz");
      }
    } else {
      int k = 0;
      for (const char* name : {"inertia_xx", "inertia_yy", "inertia_zz", "inertia_xy", "inertia_xz", "inertia_yz"}) {
        c[static_cast<std::size_t>(k++)] = NumberOr(node.child(name), 0);
      }
    }
    Mat3 inertia;
    inertia << c[0], c[3], c[4], c[3], c[1], c[5], c[4], c[5], c[2];
    return inertia;
  }

  // Meshes for pictures, and surfaces for wrapping.
  void ReadSurfacesOf(pugi::xml_node body, int bone) {
    if (bone >= 0) {
      for (const pugi::xml_node mesh : body.child("attached_geometry").children("Mesh")) {
        BoneSurface surface;
        surface.file = xml_.Text(mesh.child("mesh_file"));
        surface.scale = VectorOr(mesh.child("scale_factors"), Vec3::Ones());
        skeleton_.bones[static_cast<std::size_t>(bone)].surfaces.push_back(std::move(surface));
      }
      for (const pugi::xml_node mesh :
           body.child("VisibleObject").child("GeometrySet").child("objects").children("DisplayGeometry")) {
        BoneSurface surface;
        surface.file = xml_.Text(mesh.child("geometry_file"));
        surface.scale = VectorOr(mesh.child("scale_factors"), Vec3::Ones());
        skeleton_.bones[static_cast<std::size_t>(bone)].surfaces.push_back(std::move(surface));
      }
    }
    for (const pugi::xml_node node : body.child("WrapObjectSet").child("objects").children()) ReadWrap(node, bone);
  }

  void ReadWrap(pugi::xml_node node, int bone) {
    const std::string_view kind = node.name();
    wrap_names_.insert(NameOf(node));
    if (kind != "WrapCylinder" && kind != "WrapSphere" && kind != "WrapEllipsoid") {
      xml_.Tell(Notice::Kind::kNotTaken, node, "muscles do not wrap around it",
                "use a cylinder, a sphere or an ellipsoid");
      return;
    }
    if (node.child("active") && !xml_.Flag(node.child("active"))) return;
    WrapSurface surface;
    surface.name = NameOf(node);
    surface.bone = bone;
    surface.pose = PoseByAngles(VectorOr(node.child("translation"), Vec3::Zero()),
                                VectorOr(node.child("xyz_body_rotation"), Vec3::Zero()));
    if (kind == "WrapEllipsoid") {
      surface.kind = WrapSurface::Kind::kEllipsoid;
      surface.radii = VectorOr(node.child("dimensions"), Vec3::Zero());
      if (!(surface.radii.minCoeff() > 0)) xml_.Fail(node, "its dimensions must be positive");
    } else {
      surface.kind = kind == "WrapCylinder" ? WrapSurface::Kind::kCylinder : WrapSurface::Kind::kSphere;
      surface.radius = NumberOr(node.child("radius"), 0);
      surface.length = NumberOr(node.child("length"), 0);
      if (!(surface.radius > 0)) xml_.Fail(node, "its radius must be positive");
    }
    ReadQuadrant(node.child("quadrant"), surface);
    surfaces_.emplace(surface.name, static_cast<int>(skeleton_.surfaces.size()));
    skeleton_.surfaces.push_back(std::move(surface));
  }

  void ReadQuadrant(pugi::xml_node node, WrapSurface& surface) {
    const std::string text = node ? xml_.Text(node) : "all";
    if (text.empty() || text == "all" || text == "All") return;
    const char axis = text.back();
    if (axis < 'x' || axis > 'z' || text.size() > 2) {
      xml_.Fail(node, "`" + text + "` is not a side", "give all, x, -x, y, -y, z or -z");
      return;
    }
    surface.side_axis = axis - 'x';
    surface.side = text[0] == '-' ? -1 : 1;
  }

  // Frames of bodies; those of joints are read with them.
  void ReadFrames(pugi::xml_node model) {
    for (const pugi::xml_node body : model.child("BodySet").child("objects").children("Body")) {
      for (const pugi::xml_node frame : body.child("components").children("PhysicalOffsetFrame")) {
        AddFrame(frame, frames_);
      }
    }
    for (const pugi::xml_node frame : model.child("ComponentSet").child("objects").children("PhysicalOffsetFrame")) {
      AddFrame(frame, frames_);
    }
  }

  void AddFrame(pugi::xml_node node, std::map<std::string, Frame>& frames) {
    const Pose own = PoseByAngles(VectorOr(node.child("translation"), Vec3::Zero()),
                                  VectorOr(node.child("orientation"), Vec3::Zero()));
    const std::string parent = ParentOf(node);
    const auto known = frames.find(LastName(parent));
    if (known != frames.end() && !bones_.contains(LastName(parent))) {
      frames[NameOf(node)] = {known->second.bone, known->second.pose * own};
    } else {
      frames[NameOf(node)] = {BoneOf(node, parent), own};
    }
  }

  // The body of a frame or a point: in several versions of the format.
  std::string ParentOf(pugi::xml_node node) {
    for (const char* key : {"socket_parent", "socket_parent_frame", "socket_parent_body", "body"}) {
      if (const pugi::xml_node child = node.child(key)) return xml_.Text(child);
    }
    if (const pugi::xml_node connectors = node.child("connectors")) {
      for (const pugi::xml_node connector : connectors.children()) {
        if (const pugi::xml_node name = connector.child("connectee_name")) return xml_.Text(name);
      }
    }
    return "";
  }

  void ReadJoints(pugi::xml_node model) {
    for (const pugi::xml_node node : Objects(model, "JointSet").children()) {
      if (EndsWith(node.name(), "Joint")) ReadJoint(node, "");
    }
    // Version 3: each body has its joint.
    for (const pugi::xml_node body : model.child("BodySet").child("objects").children("Body")) {
      for (const pugi::xml_node node : body.child("Joint").children()) ReadJoint(node, NameOf(body));
    }
  }

  void ReadJoint(pugi::xml_node node, const std::string& child) {
    xml_.Take(node);
    Joint joint;
    joint.name = NameOf(node);
    if (child.empty()) {
      std::map<std::string, Frame> frames = frames_;
      for (const pugi::xml_node frame : node.child("frames").children("PhysicalOffsetFrame")) AddFrame(frame, frames);
      const Frame parent = FrameOf(node, node.child("socket_parent_frame"), frames);
      const Frame own = FrameOf(node, node.child("socket_child_frame"), frames);
      joint.parent = parent.bone;
      joint.in_parent = parent.pose;
      joint.child = own.bone;
      joint.in_child = own.pose;
    } else {
      joint.parent = BoneOf(node, xml_.Text(node.child("parent_body")));
      joint.child = BoneOf(node, child);
      joint.in_parent = PoseByAngles(VectorOr(node.child("location_in_parent"), Vec3::Zero()),
                                     VectorOr(node.child("orientation_in_parent"), Vec3::Zero()));
      joint.in_child = PoseByAngles(VectorOr(node.child("location"), Vec3::Zero()),
                                    VectorOr(node.child("orientation"), Vec3::Zero()));
    }
    if (node.child("reverse") && xml_.Flag(node.child("reverse"))) {
      xml_.Fail(node, "is reversed", "exchange its parent and its child");
    }
    const std::vector<int> coordinates = ReadCoordinates(node);
    if (joint.child == Joint::kGround) xml_.Fail(node, "moves the ground");
    SetAxes(node, coordinates, joint);
    if (joint.parent == kUnknown || joint.child < 0) return;
    joint_nodes_.push_back(node);
    skeleton_.joints.push_back(std::move(joint));
  }

  Frame FrameOf(pugi::xml_node joint, pugi::xml_node socket, const std::map<std::string, Frame>& frames) {
    const std::string path = xml_.Text(socket);
    const auto found = frames.find(LastName(path));
    if (found != frames.end()) return found->second;
    return {BoneOf(socket ? socket : joint, path), Pose()};
  }

  std::vector<int> ReadCoordinates(pugi::xml_node joint) {
    std::vector<int> indices;
    const pugi::xml_node set = joint.child("coordinates");
    const pugi::xml_node list = set ? set : joint.child("CoordinateSet").child("objects");
    for (const pugi::xml_node node : list.children("Coordinate")) {
      xml_.Take(node);
      Coordinate coordinate;
      coordinate.name = NameOf(node);
      coordinate.start = NumberOr(node.child("default_value"), 0);
      coordinate.start_speed = NumberOr(node.child("default_speed_value"), 0);
      if (const auto range = node.child("range") ? xml_.Pair(node.child("range")) : std::nullopt) {
        coordinate.range = *range;
      }
      coordinate.locked = node.child("locked") && xml_.Flag(node.child("locked"));
      if (coordinate.name.empty() || IndexOf(skeleton_.coordinates, coordinate.name) >= 0) {
        xml_.Fail(node, coordinate.name.empty() ? "has no name" : "this name is given twice");
      }
      indices.push_back(static_cast<int>(skeleton_.coordinates.size()));
      skeleton_.coordinates.push_back(std::move(coordinate));
    }
    return indices;
  }

  void SetAxes(pugi::xml_node node, const std::vector<int>& coordinates, Joint& joint) {
    const std::string_view kind = node.name();
    for (int k = 0; k < 3; ++k) {
      const auto axis = static_cast<std::size_t>(k);
      joint.rotations[axis].axis = joint.translations[axis].axis = Vec3::Unit(k);
    }
    if (kind == "CustomJoint") return ReadTransform(node.child("SpatialTransform"), joint);
    // The axes that coordinates move in their order; 0 to 2 are rotations, 3 to 5 translations.
    static const std::map<std::string_view, std::vector<int>> kAxes = {
        {"WeldJoint", {}},          {"PinJoint", {2}},
        {"SliderJoint", {3}},       {"UniversalJoint", {0, 1}},
        {"BallJoint", {0, 1, 2}},   {"GimbalJoint", {0, 1, 2}},
        {"PlanarJoint", {2, 3, 4}}, {"FreeJoint", {0, 1, 2, 3, 4, 5}}};
    const auto found = kAxes.find(kind);
    if (found == kAxes.end()) {
      xml_.Fail(node, "joints of this kind are not supported", "use a CustomJoint");
      return;
    }
    if (found->second.size() != coordinates.size()) {
      xml_.Fail(node, "has " + std::to_string(coordinates.size()) + " coordinates where " +
                          std::to_string(found->second.size()) + " should be");
      return;
    }
    for (std::size_t k = 0; k < coordinates.size(); ++k) {
      const int which = found->second[k];
      MotionAxis& axis = which < 3 ? joint.rotations[static_cast<std::size_t>(which)]
                                   : joint.translations[static_cast<std::size_t>(which - 3)];
      axis.coordinate = coordinates[k];
      axis.function = ScalarFunction::Identity();
      skeleton_.coordinates[static_cast<std::size_t>(coordinates[k])].is_angle = which < 3;
    }
  }

  void ReadTransform(pugi::xml_node transform, Joint& joint) {
    xml_.Take(transform);
    std::set<int> turned;
    std::size_t k = 0;
    for (const pugi::xml_node node : transform.children("TransformAxis")) {
      if (k == 6) break;
      MotionAxis& axis = k < 3 ? joint.rotations[k] : joint.translations[k - 3];
      const bool is_rotation = k++ < 3;
      if (const auto direction = Optional(node.child("axis"))) {
        if (direction->norm() < 1e-9) {
          xml_.Fail(node.child("axis"), "is zero");
        } else {
          axis.axis = direction->normalized();
        }
      }
      const std::vector<std::string> names = xml_.Words(node.child("coordinates"));
      if (names.size() > 1) {
        xml_.Fail(node, "depends on several coordinates", "use a function of one of them");
        continue;
      }
      if (const auto function = ReadFunction(xml_, node)) axis.function = *function;
      if (names.empty()) continue;
      axis.coordinate = IndexOf(skeleton_.coordinates, names[0]);
      if (axis.coordinate < 0) {
        xml_.Fail(node.child("coordinates"), "there is no coordinate \"" + names[0] + "\"");
        continue;
      }
      if (is_rotation) turned.insert(axis.coordinate);
      // A coordinate is an angle if it turns something.
      skeleton_.coordinates[static_cast<std::size_t>(axis.coordinate)].is_angle = turned.contains(axis.coordinate);
    }
    if (k < 6) xml_.Fail(transform ? transform : transform.parent(), "has fewer than six axes");
  }

  // Parents before children; every bone is the child of one joint.
  void SortJoints(pugi::xml_node model) {
    std::vector<int> joint_of(skeleton_.bones.size(), -1);
    for (std::size_t j = 0; j < skeleton_.joints.size(); ++j) {
      int& own = joint_of[static_cast<std::size_t>(skeleton_.joints[j].child)];
      if (own >= 0) xml_.Fail(joint_nodes_[j], "is a second joint of its child", "loops of joints are not supported");
      own = static_cast<int>(j);
    }
    std::vector<Joint> sorted;
    std::vector<char> placed(skeleton_.bones.size(), 0);
    for (bool found = true; found;) {
      found = false;
      for (const Joint& joint : skeleton_.joints) {
        char& own = placed[static_cast<std::size_t>(joint.child)];
        if (own || (joint.parent >= 0 && !placed[static_cast<std::size_t>(joint.parent)])) continue;
        own = 1;
        sorted.push_back(joint);
        found = true;
      }
    }
    for (std::size_t b = 0; b < placed.size(); ++b) {
      if (placed[b] || xml_.failures() > 0) continue;
      xml_.Fail(model, "no joints connect body \"" + skeleton_.bones[b].name + "\" with the ground",
                joint_of[b] < 0 ? "give it a joint" : "its joints form a loop");
    }
    skeleton_.joints = std::move(sorted);
  }

  void ReadMuscles(pugi::xml_node model) {
    for (const pugi::xml_node node : Objects(model, "ForceSet").children()) {
      if (node.type() != pugi::node_element) continue;
      const pugi::xml_node path = node.child("GeometryPath");
      if (!path || !node.child("max_isometric_force")) {
        xml_.Tell(Notice::Kind::kNotTaken, node, "only muscles are taken of the forces",
                  "give other forces in the scene");
        continue;
      }
      xml_.Take(node);
      ReadMuscle(node, path);
    }
  }

  void ReadMuscle(pugi::xml_node node, pugi::xml_node path) {
    LineMuscle muscle;
    muscle.name = NameOf(node);
    muscle.max_isometric_force = NumberOr(node.child("max_isometric_force"), 0);
    muscle.optimal_fibre_length = NumberOr(node.child("optimal_fiber_length"), 0);
    muscle.tendon_slack_length = NumberOr(node.child("tendon_slack_length"), 0);
    pugi::xml_node pennation = node.child("pennation_angle_at_optimal");
    if (!pennation) pennation = node.child("pennation_angle");
    muscle.pennation = NumberOr(pennation, 0);
    ReadHill(node, muscle.hill);
    if (muscle.name.empty() || IndexOf(skeleton_.muscles, muscle.name) >= 0) {
      xml_.Fail(node, muscle.name.empty() ? "has no name" : "this name is given twice");
    }
    if (!(muscle.max_isometric_force > 0)) xml_.Fail(node, "its max_isometric_force must be positive");
    for (const pugi::xml_node point : path.child("PathPointSet").child("objects").children()) {
      if (EndsWith(point.name(), "PathPoint")) ReadPoint(point, muscle);
    }
    if (muscle.points.size() < 2) xml_.Fail(path, "has fewer than two points");
    for (const pugi::xml_node wrap : path.child("PathWrapSet").child("objects").children("PathWrap")) {
      ReadPathWrap(wrap, muscle);
    }
    skeleton_.muscles.push_back(std::move(muscle));
  }

  void ReadHill(pugi::xml_node node, HillCurves& hill) {
    if (std::string_view(node.name()) != "Thelen2003Muscle") {
      xml_.Remark(Notice::Kind::kChanged, node, "its curves are those of a Thelen2003Muscle");
    }
    hill.max_shortening_velocity = NumberOr(node.child("max_contraction_velocity"), hill.max_shortening_velocity);
    hill.tendon_strain = NumberOr(node.child("FmaxTendonStrain"), hill.tendon_strain);
    hill.passive_strain = NumberOr(node.child("FmaxMuscleStrain"), hill.passive_strain);
    hill.active_width = NumberOr(node.child("KshapeActive"), hill.active_width);
    hill.passive_shape = NumberOr(node.child("KshapePassive"), hill.passive_shape);
    hill.velocity_shape = NumberOr(node.child("Af"), hill.velocity_shape);
    hill.lengthening_force = NumberOr(node.child("Flen"), hill.lengthening_force);
    hill.activation_time = NumberOr(node.child("activation_time_constant"), hill.activation_time);
    hill.deactivation_time = NumberOr(node.child("deactivation_time_constant"), hill.deactivation_time);
  }

  void ReadPoint(pugi::xml_node node, LineMuscle& muscle) {
    PathPoint point;
    point.bone = BoneOf(node, ParentOf(node));
    point.place = VectorOr(node.child("location"), Vec3::Zero());
    const std::string_view kind = node.name();
    if (kind == "ConditionalPathPoint") {
      point.condition = CoordinateOf(node);
      if (const auto range = xml_.Pair(node.child("range"))) point.range = *range;
    } else if (kind == "MovingPathPoint") {
      int k = 0;
      for (const std::string axis : {"x", "y", "z"}) {
        const auto at = static_cast<std::size_t>(k++);
        const pugi::xml_node location = node.child((axis + "_location").c_str());
        if (const auto function = location ? ReadFunction(xml_, location) : std::nullopt) point.moved[at] = *function;
        point.moved_by[at] = CoordinateOf(node, axis);
      }
    }
    muscle.points.push_back(std::move(point));
  }

  // The coordinate of a conditional or a moving point.
  int CoordinateOf(pugi::xml_node node, const std::string& axis = "") {
    const std::string prefix = axis.empty() ? "" : axis + "_";
    for (const std::string& key : {"socket_" + prefix + "coordinate", prefix + "coordinate"}) {
      const pugi::xml_node child = node.child(key.c_str());
      if (!child) continue;
      const std::string name = LastName(xml_.Text(child));
      const int index = IndexOf(skeleton_.coordinates, name);
      if (index < 0) xml_.Fail(child, "there is no coordinate \"" + name + "\"");
      return std::max(index, 0);
    }
    xml_.Fail(node, "has no " + prefix + "coordinate");
    return 0;
  }

  void ReadPathWrap(pugi::xml_node node, LineMuscle& muscle) {
    const std::string name = LastName(xml_.Text(node.child("wrap_object")));
    const auto found = surfaces_.find(name);
    if (found == surfaces_.end()) {
      if (!wrap_names_.contains(name)) xml_.Fail(node, "there is no wrap object \"" + name + "\"");
      return;
    }
    PathWrap wrap;
    wrap.surface = found->second;
    wrap.last = static_cast<int>(muscle.points.size()) - 1;
    if (const auto range = node.child("range") ? xml_.Pair(node.child("range")) : std::nullopt) {
      // Counted from 1; -1: all.
      if ((*range)[0] >= 1) wrap.first = static_cast<int>((*range)[0]) - 1;
      if ((*range)[1] >= 1) wrap.last = std::min(wrap.last, static_cast<int>((*range)[1]) - 1);
    }
    muscle.wraps.push_back(wrap);
  }

  void TellOfSets(pugi::xml_node model) {
    for (const char* set : {"ConstraintSet", "ControllerSet", "ContactGeometrySet", "ProbeSet"}) {
      for (const pugi::xml_node node : model.child(set).child("objects").children()) {
        if (node.type() == pugi::node_element) xml_.Tell(Notice::Kind::kNotTaken, node, "is not supported");
      }
    }
  }

  XmlSource xml_;
  int version_ = 0;
  Skeleton skeleton_;
  std::map<std::string, int> bones_;
  std::map<std::string, Frame> frames_;
  std::map<std::string, int> surfaces_;
  std::set<std::string> wrap_names_;
  std::vector<pugi::xml_node> joint_nodes_;
};

}  // namespace

std::optional<OsimModel> ReadOsim(std::string_view bytes, const std::string& name, Problems& problems) {
  return OsimReader(bytes, name, problems).Read();
}

}  // namespace fascicle::client
