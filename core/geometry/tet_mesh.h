#ifndef FASCICLE_CORE_GEOMETRY_TET_MESH_H_
#define FASCICLE_CORE_GEOMETRY_TET_MESH_H_

#include <array>
#include <cstdint>
#include <stop_token>
#include <string>
#include <vector>

#include "core/base/types.h"

namespace fascicle {

using Tetrahedron = std::array<std::int32_t, 4>;  // node indices; det[X1-X0, X2-X0, X3-X0] > 0
// Node indices in the order of VTK: counter-clockwise around the lower side seen from the upper one, then around the
// upper one. A wedge or a pyramid is one with repeated nodes (solid_cells.h).
using Hexahedron = std::array<std::int32_t, 8>;
using Triangle = std::array<std::int32_t, 3>;  // node indices; counter-clockwise seen from outside

// The end nodes of each edge of a tetrahedron.
inline constexpr std::array<std::array<int, 2>, 6> kTetEdges = {{{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}}};

// An edge that is not straight.
struct CurvedEdge {
  std::array<std::int32_t, 2> ends;  // node indices
  Vec3 middle;                       // position of the mid-edge node, in the unit of the nodes
};

// Tetrahedra, or hexahedra with the six tetrahedra of each (three of a wedge, two of a pyramid), and the tags of their
// file. Plain data; mesh_checks.h
// decides whether a mesh is fit for simulation.
//
// The elements of a mesh are its hexahedra if it has any, else its tetrahedra: values of elements, such as fibres and
// materials, have one entry for each of them. The tetrahedra of each hexahedron, one after the other (FirstTetrahedra),
// serve whatever is geometric: the boundary, cross-sections, volumes.
struct TetMesh {
  std::vector<Vec3> nodes;  // [m] (readers: the file's own unit)
  std::vector<Tetrahedron> tetrahedra;
  std::vector<Hexahedron> hexahedra;           // or empty
  std::vector<std::int32_t> tetrahedron_tags;  // physical tag of each tetrahedron; empty when the file has none
  std::vector<Triangle> tagged_triangles;      // triangles listed in the file, in its own orientation
  std::vector<std::int32_t> triangle_tags;     // physical tag of each of them
  std::vector<std::int32_t> tagged_nodes;      // single nodes listed in the file
  std::vector<std::int32_t> node_tags;         // physical tag of each of them
  std::vector<CurvedEdge> curved_edges;        // for quadratic elements; all other edges are straight
  // Tetrahedra with more than one physical tag: index and tag, for each tag but the one in `tetrahedron_tags`.
  std::vector<std::array<std::int32_t, 2>> further_tags;
};

// A name for a physical tag.
struct TagName {
  int dimension = 2;  // 0: of nodes, 2: of triangles, 3: of tetrahedra
  std::int32_t tag = 0;
  std::string name;  // without quotes
};

// det[X1-X0, X2-X0, X3-X0] / 6 [m^3].
double SignedVolume(const TetMesh& mesh, std::size_t tetrahedron);
// Mean of the four nodes [m].
Vec3 Centroid(const TetMesh& mesh, std::size_t tetrahedron);
// Number of elements: hexahedra, or else tetrahedra.
inline std::size_t ElementCount(const TetMesh& mesh) {
  return mesh.hexahedra.empty() ? mesh.tetrahedra.size() : mesh.hexahedra.size();
}
// Mean of an element's nodes [m].
Vec3 ElementCentroid(const TetMesh& mesh, std::size_t element);
// Sum of the signed volumes [m^3].
double TotalVolume(const TetMesh& mesh);
// Faces that belong to one tetrahedron only, oriented outward, in a fixed order. Throws Stopped after a stop request.
std::vector<Triangle> BoundaryTriangles(const TetMesh& mesh, const std::stop_token& stop = {});

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_TET_MESH_H_
