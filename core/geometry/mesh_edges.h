#ifndef FASCICLE_CORE_GEOMETRY_MESH_EDGES_H_
#define FASCICLE_CORE_GEOMETRY_MESH_EDGES_H_

#include <array>
#include <cstdint>
#include <stop_token>
#include <vector>

#include "core/geometry/tet_mesh.h"

namespace fascicle {

// The edges of a mesh of tetrahedra, numbered in the order in which its tetrahedra first refer to them. Quadratic
// elements have a mid-edge node on each; the mid-edge nodes of a body follow the nodes of its mesh in this order, in
// the model, in initial displacements and in frames.
struct MeshEdges {
  std::vector<std::array<std::int32_t, 2>> ends;           // of each edge, the lower node first
  std::vector<std::array<std::int32_t, 6>> of_tetrahedra;  // numbers of edges, in the order of kTetEdges

  // The number of the edge between two nodes; -1 if there is none. Takes logarithmic time.
  std::int32_t Between(std::int32_t i, std::int32_t j) const;

  // Numbers of edges, by their ends ascending.
  std::vector<std::int32_t> sorted;
};

// Time grows as n log n. Throws Stopped after a stop request.
MeshEdges NumberEdges(const TetMesh& mesh, const std::stop_token& stop = {});

// The place of the mid-edge node on every edge, straight or curved, in the unit of the mesh's nodes.
std::vector<Vec3> EdgeMiddles(const TetMesh& mesh, const MeshEdges& edges);

// For each edge whether its mid-edge node belongs to a set of nodes: both ends do, and the edge is on the boundary or
// in a tetrahedron all of whose corners do. (An edge through the body between two sides of a region does not.)
//   boundary  BoundaryTriangles(mesh)
std::vector<bool> EdgesWithin(const TetMesh& mesh, const MeshEdges& edges, const std::vector<Triangle>& boundary,
                              const std::vector<std::int32_t>& nodes);

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_MESH_EDGES_H_
