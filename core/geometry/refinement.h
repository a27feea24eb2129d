#ifndef FASCICLE_CORE_GEOMETRY_REFINEMENT_H_
#define FASCICLE_CORE_GEOMETRY_REFINEMENT_H_

#include <array>
#include <cstdint>
#include <stop_token>
#include <vector>

#include "core/geometry/tet_mesh.h"
#include "core/geometry/voxel_grid.h"

namespace fascicle {

// Uniform refinement: every edge is cut in half. Functions throw Stopped after a stop request.

// The number of parts into which an element is divided.
inline constexpr std::size_t kChildren = 8;

struct RefinedTetrahedra {
  // The nodes of the coarse mesh in their order, then a mid-edge node for every edge. The parts of tetrahedron t
  // are tetrahedra 8 t to 8 t + 7. Tags are those of the parents; a node between two tagged nodes has their tag.
  TetMesh mesh;
  // The ends of the edge of each mid-edge node.
  std::vector<std::array<std::int32_t, 2>> ends;
};

// Cuts off the four corners of each tetrahedron and divides the octahedron between them along its shortest
// diagonal. Curved edges remain the parabolas that they were: the refined mesh of quadratic elements has the shape of
// the coarse one.
RefinedTetrahedra Refined(const TetMesh& mesh, const std::stop_token& stop = {});

struct RefinedHexahedra {
  // The nodes of the coarse mesh in their order, then those in the middle of edges, sides and hexahedra. The parts of
  // hexahedron h are hexahedra 8 h to 8 h + 7, split by SplitHexahedra. Tags are those of the parents; of triangles,
  // those of the side that they are on. A node in the middle of tagged nodes has their tag.
  TetMesh mesh;
  // The two, four or eight nodes in whose middle each new node is.
  std::vector<std::vector<std::int32_t>> between;
};

// Divides every hexahedron of a mesh of hexahedra in eight. The sides remain the bilinear ones that they were.
RefinedHexahedra RefinedIntoHexahedra(const TetMesh& mesh, const std::stop_token& stop = {});

// Divides every voxel in eight with its material and stiffness. At most 2^31 - 1 voxels may result.
VoxelGrid Refined(const VoxelGrid& grid, const std::stop_token& stop = {});

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_REFINEMENT_H_
