#ifndef FASCICLE_CORE_SCENE_ACTING_H_
#define FASCICLE_CORE_SCENE_ACTING_H_

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>

#include "core/base/curve.h"
#include "core/base/types.h"
#include "core/muscle/stern_muscle.h"
#include "core/scene/fields.h"

namespace fascicle {

// What acts on bodies: supports and their motions, loads, gravity, floors and force fields.

template <>
inline constexpr auto kFieldNames<Curve> = FieldNames("times", "values", "interpolation");

struct Rotation {
  Vec3 point = Vec3::Zero();  // [m]
  Vec3 axis = Vec3::UnitZ();  // unit
  Curve angle;                // [rad]
};
template <>
inline constexpr auto kFieldNames<Rotation> = FieldNames("point", "axis", "angle");

struct Motion {
  std::array<std::optional<Curve>, 3> translation;  // along x, y, z [m]
  std::optional<Rotation> rotation;
  std::int32_t bone = -1;  // of the scene's skeleton, in place of the others: that from its pose at time 0; -1: none
};
template <>
inline constexpr auto kFieldNames<Motion> = FieldNames("translation", "rotation", "bone");

struct Constraint {
  std::int32_t region = 0;  // index into Body::regions
  std::array<bool, 3> axes = {true, true, true};
  Motion motion;
};
template <>
inline constexpr auto kFieldNames<Constraint> = FieldNames("region", "axes", "motion");

struct Traction {
  Vec3 vector = Vec3::Zero();  // [Pa] of rest area
};
template <>
inline constexpr auto kFieldNames<Traction> = FieldNames("vector");

struct NodalForce {
  Vec3 total = Vec3::Zero();  // [N], in equal parts on the nodes of the region
};
template <>
inline constexpr auto kFieldNames<NodalForce> = FieldNames("total");

// Against the outward normal of the deformed surface.
struct Pressure {
  double value = 0;  // [Pa]
};
template <>
inline constexpr auto kFieldNames<Pressure> = FieldNames("value");

struct BodyForce {
  Vec3 density = Vec3::Zero();  // [N/m^3] of rest volume
};
template <>
inline constexpr auto kFieldNames<BodyForce> = FieldNames("density");

// Springs that pull a region to its rest position.
struct Springs {
  Vec3 stiffness =
      Vec3::Zero();  // along x, y, z [N/m], in equal parts of the region's area, or on its nodes if it has no faces
};
template <>
inline constexpr auto kFieldNames<Springs> = FieldNames("stiffness");

// A spring along the line between the middles of two regions: the means of their positions over their area, or over
// their nodes if they have no faces.
struct LineSpring {
  std::int32_t body = 0, region = 0;  // the other end: indices into Scene::bodies and Body::regions
  double stiffness = 0;               // [N/m]
  std::optional<double> rest_length;  // [m]; the distance at rest when absent
  bool tension_only = false;          // whether it goes slack when it is shorter, as a ligament does
};
template <>
inline constexpr auto kFieldNames<LineSpring> = FieldNames("body", "region", "stiffness", "rest_length",
                                                           "tension_only");

template <>
inline constexpr auto kFieldNames<SternMuscle> = FieldNames("origin_distance", "insertion_distance", "peak_force",
                                                            "optimal_angle", "contractile_fraction", "hill_curvature",
                                                            "hill_rate", "eccentric_force");
template <>
inline constexpr auto kFieldNames<SternDrive> = FieldNames("angle", "activation");

// The force of a muscle across a joint [N].
struct SternPull {
  SternMuscle muscle;
  SternDrive drive;
};
template <>
inline constexpr auto kFieldNames<SternPull> = FieldNames("", "");

struct Load {
  std::int32_t region = 0;  // index into Body::regions
  std::variant<Traction, NodalForce, Pressure, BodyForce, Springs, LineSpring> kind;
  Curve scale = Curve::Constant(1);
  std::optional<SternPull> stern;  // replaces the scale of a unit force; a series in the output
};
template <>
inline constexpr auto kFieldNames<Load> = FieldNames("region", "", "scale", "stern");

struct Gravity {
  Vec3 acceleration = Vec3::Zero();  // [m/s^2]
  Curve scale = Curve::Constant(1);
};
template <>
inline constexpr auto kFieldNames<Gravity> = FieldNames("acceleration", "scale");

// A rigid half-space that bodies cannot enter: all x with (x - point) . normal < 0.
struct Floor {
  std::string name;
  Vec3 point = Vec3::Zero();    // [m]
  Vec3 normal = Vec3::UnitZ();  // unit, outward
};
template <>
inline constexpr auto kFieldNames<Floor> = FieldNames("name", "point", "normal");

// A plane force field: a force per deformed volume towards a plane.
struct PlaneForceField {
  Vec3 point = Vec3::Zero();    // [m]
  Vec3 normal = Vec3::UnitX();  // unit
  double force_density = 0;     // [N/m^3]
  double width = 0;             // distance from the plane within which it is proportional to the distance [m]
  Curve scale = Curve::Constant(1);
};
template <>
inline constexpr auto kFieldNames<PlaneForceField> = FieldNames("point", "normal", "force_density", "width", "scale");

}  // namespace fascicle

#endif  // FASCICLE_CORE_SCENE_ACTING_H_
