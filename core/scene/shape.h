#ifndef FASCICLE_CORE_SCENE_SHAPE_H_
#define FASCICLE_CORE_SCENE_SHAPE_H_

#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

#include "core/base/curve.h"
#include "core/geometry/brick_mesh.h"
#include "core/geometry/tet_mesh.h"
#include "core/geometry/triangle_mesh.h"
#include "core/materials/material.h"
#include "core/materials/prony.h"
#include "core/muscle/fibre_field.h"
#include "core/scene/fields.h"

namespace fascicle {

// The shape of a body at rest, and data of its parts. Each method has its own type of shape. All have a `mesh` [m];
// frames, regions and probes refer to its nodes.

template <>
inline constexpr auto kFieldNames<CurvedEdge> = FieldNames("ends", "middle");
template <>
inline constexpr auto kFieldNames<TetMesh> = FieldNames("nodes", "tetrahedra", "hexahedra", "tetrahedron_tags",
                                                        "tagged_triangles", "triangle_tags", "tagged_nodes",
                                                        "node_tags", "curved_edges", "further_tags");
template <>
inline constexpr auto kFieldNames<VoxelGrid> = FieldNames("size", "spacing", "origin", "direction", "material",
                                                          "stiffness");
template <>
inline constexpr auto kFieldNames<BrickMesh> = FieldNames("grid", "nodes", "bricks", "labels");
template <>
inline constexpr auto kFieldNames<TriangleMesh> = FieldNames("nodes", "triangles");

// Values besides that of the whole body, and the value of each element.
template <class Value>
struct Parts {
  std::vector<Value> more;
  std::vector<std::int32_t> of;  // 0: the body's value, k: more[k - 1]; empty: all have the body's value
};
template <class Value>
inline constexpr auto kFieldNames<Parts<Value>> = FieldNames("", "of");

template <>
inline constexpr auto kFieldNames<PronyTerm> = FieldNames("strength", "time");
template <>
inline constexpr auto kFieldNames<PronySeries> = FieldNames("terms");

// Tetrahedra or hexahedra, for the tet method.
struct TetShape {
  TetMesh mesh;
  FibreField fibres;  // one for each element, or none
  // Stretch of the fibres of each element at rest, which multiplies that in their laws [1]; empty: 1.
  std::vector<double> prestretch;
  Parts<Material> materials;
  std::vector<PronySeries> viscoelasticity;  // of each of materials.more; empty: these are elastic
  Parts<Curve> activations;
  std::vector<double> activation_scale;  // fraction of the activation that reaches each element [0, 1]; empty: 1
  // Of each node of the mesh at time 0; for quadratic elements optionally followed by those of the mid-edge nodes, in
  // the order of MeshEdges; empty: none. Displacements may tangle the mesh [m]; velocities [m/s].
  std::vector<Vec3> initial_displacement, initial_velocity;
};
template <>
inline constexpr auto kFieldNames<TetShape> = FieldNames("mesh", "fibres", "prestretch", "region_materials",
                                                         "viscoelasticity", "region_activations", "activation_scale",
                                                         "initial_displacement", "initial_velocity");

// Bricks, the solid voxels of a grid, for the voxel method.
struct VoxelShape {
  BrickMesh mesh;
  Parts<Material> materials;
};
template <>
inline constexpr auto kFieldNames<VoxelShape> = FieldNames("mesh", "region_materials");

// Isochoric plastic flow [Fan 2013, 3.5; Bargteil et al. 2007].
struct Plasticity {
  double yield_stress = 0;     // von Mises Cauchy stress above which the body flows [Pa]
  double relaxation_time = 0;  // time constant of the decay of the stress above it [s]; 0: at once
};
template <>
inline constexpr auto kFieldNames<Plasticity> = FieldNames("yield_stress", "relaxation_time");

// A closed surface, for the eulerian method.
struct SurfaceShape {
  TriangleMesh mesh;
  TetMesh filling;    // tetrahedra inside of the surface, which carry the fibres [m]; may be empty
  FibreField fibres;  // one for each tetrahedron of the filling, or one for a body without filling, or none
  std::optional<Plasticity> plasticity;
};
template <>
inline constexpr auto kFieldNames<SurfaceShape> = FieldNames("mesh", "filling", "fibres", "plasticity");

using Shape = std::variant<TetShape, VoxelShape, SurfaceShape>;

}  // namespace fascicle

#endif  // FASCICLE_CORE_SCENE_SHAPE_H_
