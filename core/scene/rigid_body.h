#ifndef FASCICLE_CORE_SCENE_RIGID_BODY_H_
#define FASCICLE_CORE_SCENE_RIGID_BODY_H_

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/pose.h"
#include "core/geometry/obstacle.h"
#include "core/scene/rigid_motion.h"
#include "core/scene/shape.h"

namespace fascicle {

template <>
inline constexpr auto kFieldNames<Ball> = FieldNames("radius");
template <>
inline constexpr auto kFieldNames<Cuboid> = FieldNames("size");
template <>
inline constexpr auto kFieldNames<Cylinder> = FieldNames("radius", "length");
template <>
inline constexpr auto kFieldNames<Pose> = FieldNames("position", "rotation");

// Motion under gravity and the forces of bodies. One of mass and density is given.
struct FreeRigidMotion {
  std::optional<double> mass;     // [kg]
  std::optional<double> density;  // [kg/m^3]
  Vec3 velocity = Vec3::Zero();   // of the centre of mass at time 0 [m/s]
  Vec3 spin = Vec3::Zero();       // angular velocity at time 0 [rad/s]
};
template <>
inline constexpr auto kFieldNames<FreeRigidMotion> = FieldNames("mass", "density", "velocity", "spin");

// An obstacle that bodies cannot enter. At most one of motion, free and bone is given; without any it does not move.
struct RigidBody {
  std::string name;
  ObstacleShape shape;
  Pose pose;                            // at time 0; relative to the bone, if there is one
  std::optional<Motion> motion;         // prescribed, from the pose at time 0
  std::optional<FreeRigidMotion> free;  // under forces
  std::string bone;                     // of the scene's skeleton; empty: none
  double friction = 0;                  // Coulomb's coefficient [1]
  std::vector<std::int32_t> bodies;     // indices of the bodies that it touches; all when empty
};
template <>
inline constexpr auto kFieldNames<RigidBody> = FieldNames("name", "shape", "pose", "motion", "free", "bone", "friction",
                                                          "bodies");

bool Touches(const RigidBody& rigid, std::size_t body);

// The motion of a body at a time: prescribed, or none.
RigidMotion RigidMotionAt(const RigidBody& rigid, double time);

// The pose after a motion from the pose at time 0.
Pose PoseAfter(const Pose& pose, const RigidMotion& motion);

}  // namespace fascicle

#endif  // FASCICLE_CORE_SCENE_RIGID_BODY_H_
