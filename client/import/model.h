#ifndef FASCICLE_CLIENT_IMPORT_MODEL_H_
#define FASCICLE_CLIENT_IMPORT_MODEL_H_

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <pugixml.hpp>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "client/import/expression.h"
#include "client/import/units.h"
#include "client/import/xml_source.h"
#include "core/base/types.h"
#include "core/geometry/tet_mesh.h"

namespace fascicle::client {

// The supported part of a FEBio model, in the model's units. Plain data, filled by sections.h.

// kOtherSolid and kNoVolume (shells, beams) occur in rigid bodies only.
enum class Shape { kTet4, kTet10, kHex8, kPenta6, kPyra5, kOtherSolid, kNoVolume };

// An <Elements> section.
struct Part {
  std::string name;
  pugi::xml_node node;
  std::string type;  // "tet4"
  Shape shape = Shape::kTet4;
  std::size_t count = 4;  // nodes of an element
  std::vector<std::int64_t> ids;
  std::vector<std::int32_t> nodes;  // indices, `count` for each element
  std::int32_t material = -1;       // index, or -1 if the part is no deformable solid
  std::int32_t rigid = -1;          // index of its material if that is a rigid body
  std::size_t size() const { return ids.size(); }
};

struct NodeSet {
  std::vector<std::int32_t> nodes;  // indices
  pugi::xml_node node;
};

struct Facet {
  int corners = 3;                   // 3 or 4
  std::array<std::int32_t, 4> node;  // indices, in order around the facet
};

struct Surface {
  std::vector<Facet> facets;
  std::vector<std::int32_t> middles;  // mid-edge nodes
  pugi::xml_node node;
};

struct Mesh {
  std::vector<Vec3> nodes;
  std::vector<std::int64_t> ids;
  std::unordered_map<std::int64_t, std::int32_t> index_of;
  std::vector<Part> parts;
  std::unordered_map<std::string, std::size_t> part_index;  // by name
  // Index of the part and index within it of an element, by its id.
  std::unordered_map<std::int64_t, std::pair<std::int32_t, std::int32_t>> element_index;
  std::map<std::string, NodeSet> node_sets;
  std::map<std::string, Surface> surfaces;
  std::map<std::string, std::vector<std::int64_t>> element_sets;  // element ids
};

// A vector that turns with the direction from a centre, or from a line through it, to the point in question.
struct Round {
  Vec3 centre = Vec3::Zero();
  std::optional<Vec3> axis;  // of unit length; about a centre without one
  Vec3 vector = Vec3::UnitX();
};

// A right-handed orthonormal frame, given explicitly, by three nodes of each element, or by its centroid.
struct Axes {
  Mat3 given = Mat3::Identity();
  std::optional<std::array<int, 3>> local;  // counted from 0
  std::optional<Round> round;
  pugi::xml_node node;
};

// Definition of a material's fibre direction in its axes.
struct FibreSource {
  enum class Kind { kVector, kLocal, kMap, kRound };
  Kind kind = Kind::kVector;
  Vec3 vector = Vec3::UnitX();
  Round round;
  std::array<int, 2> local = {0, 1};  // counted from 0
  std::string map;
  pugi::xml_node node;
};

struct ImportedMaterial {
  std::string name;
  std::int64_t id = 0;
  pugi::xml_node node;
  bool rigid = false;
  bool used = false;  // by a deformable part
  v1::Material law;   // in SI
  bool needs_fibres = false;
  FibreSource fibre;
  std::vector<Axes> axes;  // from outer to inner
  double density = 0;      // [kg/m^3]; 0 if absent
  // Activation of the law in [0, 1]: this number, times a controller.
  std::optional<Driven> activation;
  std::optional<Vec3> centre;  // of mass of a rigid body, if given
};

// A degree of freedom of a rigid body.
struct RigidMotion {
  bool held = false;
  std::optional<Driven> motion;  // fixed without one; displacement, or angle [rad]
  pugi::xml_node node;
};

// What the model says of the rigid body of a material.
struct RigidBody {
  std::array<RigidMotion, 6> motions;                        // along x, y, z; about x, y, z
  std::vector<std::pair<std::string, pugi::xml_node>> sets;  // node sets attached to it
  std::vector<pugi::xml_node> forces;                        // loads and initial velocities of the body
};

// A rotation about a line, of the supports of a rigid body.
struct RigidRotation {
  Vec3 point = Vec3::Zero();
  Vec3 axis = Vec3::UnitX();
  Driven angle;
};

struct LoadCurve {
  enum class Interpolation { kLinear, kStep, kSmooth, kSmoothStep, kSpline };
  enum class Extension { kConstant, kExtrapolate, kRepeat, kRepeatOffset, kZero };
  std::vector<double> times, values;  // of a formula: the ends of its interval, if it has one
  std::optional<Expression> formula;  // of the time t
  Interpolation interpolation = Interpolation::kLinear;
  Extension extension = Extension::kConstant;         // after the last point
  Extension extension_before = Extension::kConstant;  // before the first
  std::string refused;                                // why it is not supported; empty if it is
  pugi::xml_node node;
};

// A displacement of a set of nodes along one axis; fixed if there is no motion.
struct Support {
  std::string set;
  int axis = 0;
  std::optional<Driven> motion;
  pugi::xml_node node;
  std::int32_t rotation = -1;  // index of a rotation, or -1
};

struct NodalForces {
  std::string set;
  Vec3 each = Vec3::Zero();  // on each node
  std::optional<std::int64_t> controller;
  pugi::xml_node node;
};

struct SurfaceLoad {
  std::string surface;
  Vec3 traction = Vec3::Zero();
  double pressure = 0;          // positive against the outward normal
  bool follows = false;         // whether the pressure follows the deformed surface
  std::vector<double> factors;  // of each facet; 1 if empty
  std::optional<std::int64_t> controller;
  pugi::xml_node node;
};

struct BodyForce {
  Vec3 acceleration = Vec3::Zero();
  std::optional<std::int64_t> controller;
  pugi::xml_node node;
};

struct Control {
  bool dynamic = false;
  double steps = 0, step_size = 0, stride = 1;
  pugi::xml_node node;
};

// A direction, or a frame, for each element of a set.
struct ElementData {
  std::unordered_map<std::int64_t, Vec3> fibres;  // by element id
  std::unordered_map<std::int64_t, Mat3> axes;
  std::map<std::string, std::unordered_map<std::int64_t, Vec3>> maps;  // by name
};

// A number for each facet of a surface.
struct SurfaceMap {
  std::string surface;
  std::vector<double> values;
};

struct Model {
  UnitSystem units;
  std::string version;
  Control control;
  Mesh mesh;
  bool of_hexahedra = false;  // whether the hexahedra of deformable parts are kept
  std::vector<ImportedMaterial> materials;
  std::unordered_map<std::string, std::size_t> material_index;  // by name, and by number where no name is the same
  ElementData data;
  std::map<std::string, SurfaceMap> surface_maps;  // by name
  std::map<std::int64_t, LoadCurve> curves;
  std::vector<Support> supports;
  std::map<std::int32_t, RigidBody> rigid_bodies;  // by index of the material
  std::vector<RigidRotation> rotations;
  std::vector<NodalForces> nodal_forces;
  std::vector<SurfaceLoad> surface_loads;
  std::vector<BodyForce> body_forces;
};

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_IMPORT_MODEL_H_
