#ifndef FASCICLE_CORE_SCENE_DRIVEN_SKELETON_H_
#define FASCICLE_CORE_SCENE_DRIVEN_SKELETON_H_

#include <string>
#include <vector>

#include "core/base/curve.h"
#include "core/geometry/triangle_mesh.h"
#include "core/scene/acting.h"
#include "core/scene/fields.h"
#include "core/scene/rigid_body.h"
#include "core/skeleton/muscle_strength.h"
#include "core/skeleton/skeleton.h"
#include "core/skeleton/skeleton_motion.h"

namespace fascicle {

template <>
inline constexpr auto kFieldNames<ScalarFunction> = FieldNames("x", "coefficients");
template <>
inline constexpr auto kFieldNames<BoneSurface> = FieldNames("file", "scale", "placement");
template <>
inline constexpr auto kFieldNames<Bone> = FieldNames("name", "mass", "mass_centre", "inertia", "shapes");
template <>
inline constexpr auto kFieldNames<Coordinate> = FieldNames("name", "", "value", "speed", "range", "locked");
template <>
inline constexpr auto kFieldNames<MotionAxis> = FieldNames("axis", "coordinate", "function");
template <>
inline constexpr auto kFieldNames<Joint> = FieldNames("name", "parent", "child", "in_parent", "in_child", "rotations",
                                                      "translations");
template <>
inline constexpr auto kFieldNames<WrapSurface> = FieldNames("name", "bone", "placement", "kind", "radius", "length",
                                                            "radii", "side", "side");
template <>
inline constexpr auto kFieldNames<PathPoint> = FieldNames("bone", "place", "condition", "range", "moved", "moved");
template <>
inline constexpr auto kFieldNames<PathWrap> = FieldNames("surface", "first_point", "last_point");
template <>
inline constexpr auto kFieldNames<HillCurves> = FieldNames("max_shortening_velocity", "tendon_strain", "passive_strain",
                                                           "active_width", "passive_shape", "velocity_shape",
                                                           "lengthening_force", "activation_time", "deactivation_time",
                                                           "is_early");
template <>
inline constexpr auto kFieldNames<LineMuscle> = FieldNames("name", "points", "wraps", "max_isometric_force",
                                                           "optimal_fibre_length", "tendon_slack_length", "pennation",
                                                           "");
template <>
inline constexpr auto kFieldNames<Skeleton> = FieldNames("", "gravity", "bones", "joints", "coordinates",
                                                         "wrap_surfaces", "muscles");
template <>
inline constexpr auto kFieldNames<CoordinateMotion> = FieldNames("function", "first", "last");
template <>
inline constexpr auto kFieldNames<SkeletonMotion> = FieldNames("coordinates");

// A skeleton that moves as prescribed, and its muscles' activations.
struct DrivenSkeleton {
  Skeleton skeleton;
  std::vector<TriangleMesh> shapes;  // of each bone, in its frame [m]
  SkeletonMotion motion;             // of each coordinate
  MuscleStrength strength = MuscleStrength::kConstant;
  std::vector<Curve> activations;  // of each muscle, in [0, 1]
  // Remarks for the user; without effect on results.
  std::vector<std::string> notes;
};
template <>
inline constexpr auto kFieldNames<DrivenSkeleton> = FieldNames("", "shapes", "motion", "strength", "drive", "notes");

}  // namespace fascicle

#endif  // FASCICLE_CORE_SCENE_DRIVEN_SKELETON_H_
