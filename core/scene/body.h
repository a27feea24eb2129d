#ifndef FASCICLE_CORE_SCENE_BODY_H_
#define FASCICLE_CORE_SCENE_BODY_H_

#include <array>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/base/curve.h"
#include "core/geometry/region.h"
#include "core/materials/material.h"
#include "core/muscle/activation.h"
#include "core/scene/acting.h"
#include "core/scene/fields.h"
#include "core/scene/shape.h"

namespace fascicle {

struct Damping {
  double mass_proportional = 0;       // [1/s]
  double stiffness_proportional = 0;  // [s]
  double viscosity = 0;               // [Pa s]
};
template <>
inline constexpr auto kFieldNames<Damping> = FieldNames("mass_proportional", "stiffness_proportional", "viscosity");

template <>
inline constexpr auto kFieldNames<TagSelector> = FieldNames("tag");
template <>
inline constexpr auto kFieldNames<PlaneSelector> = FieldNames("point", "normal");
template <>
inline constexpr auto kFieldNames<BoxSelector> = FieldNames("min", "max");
template <>
inline constexpr auto kFieldNames<SphereSelector> = FieldNames("center", "radius");
template <>
inline constexpr auto kFieldNames<SideSelector> = FieldNames("direction", "max_angle", "depth");
template <>
inline constexpr auto kFieldNames<Region> = FieldNames("name", "nodes", "triangles", "elements", "quads", "sides",
                                                       "selectors");

template <>
inline constexpr auto kFieldNames<ActivationDynamics> = FieldNames("activation_time", "deactivation_time",
                                                                   "initial_activation");

// The input of a muscle's activation dynamics.
struct Excitation {
  Curve curve = Curve::Constant(0);  // in [0, 1]
  ActivationDynamics dynamics;
};
template <>
inline constexpr auto kFieldNames<Excitation> = FieldNames("curve", "");

struct Body {
  std::string name;
  Shape shape;
  double density = 1060;  // at rest [kg/m^3]
  Material material = NeoHookean(std::array{1e4, 0.3});
  Damping damping;
  Curve activation = Curve::Constant(0);  // in [0, 1]
  std::optional<Excitation> excitation;   // from which the activation follows, in place of the curve
  std::vector<Region> regions;            // of the shape's mesh
  std::vector<Constraint> constraints;
  std::vector<Load> loads;
  // Remarks for the user on how the body was built; without effect on results.
  std::vector<std::string> notes;

  // The shape, which must have this type.
  const TetShape& tet() const { return std::get<TetShape>(shape); }
  TetShape& tet() { return std::get<TetShape>(shape); }
  const VoxelShape& voxel() const { return std::get<VoxelShape>(shape); }
  VoxelShape& voxel() { return std::get<VoxelShape>(shape); }
  const SurfaceShape& surface() const { return std::get<SurfaceShape>(shape); }
  SurfaceShape& surface() { return std::get<SurfaceShape>(shape); }

  // Nodes of the shape's mesh at rest [m].
  const std::vector<Vec3>& nodes() const {
    return std::visit([](const auto& s) -> const std::vector<Vec3>& { return s.mesh.nodes; }, shape);
  }
};
template <>
inline constexpr auto kFieldNames<Body> = FieldNames("name", "", "density", "material", "damping", "activation",
                                                     "excitation", "regions", "constraints", "loads", "notes");

}  // namespace fascicle

#endif  // FASCICLE_CORE_SCENE_BODY_H_
