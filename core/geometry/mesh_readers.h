#ifndef FASCICLE_CORE_GEOMETRY_MESH_READERS_H_
#define FASCICLE_CORE_GEOMETRY_MESH_READERS_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "core/base/problems.h"
#include "core/geometry/tet_mesh.h"

namespace fascicle {

// A mesh as its file has it, before nodes are looked up. The readers fill one.
struct RawMesh {
  // Node numbers; empty when the nodes are numbered in order from `first_node`.
  std::vector<std::int64_t> node_numbers;
  std::int64_t first_node = 0;
  std::vector<Vec3> nodes;
  std::vector<std::array<std::int64_t, 4>> tetrahedra;
  // Of tetrahedra of ten nodes: those in the middle of the edges, in the order of kTetEdges. One for each tetrahedron,
  // or none at all.
  std::vector<std::array<std::int64_t, 6>> middles;
  std::vector<std::int64_t> tetrahedron_tags;  // as many as tetrahedra, 0 where there is none
  std::vector<std::array<std::int64_t, 3>> triangles;
  std::vector<std::int64_t> triangle_tags;  // as many as triangles
  std::vector<std::array<std::int64_t, 1>> points;
  std::vector<std::int64_t> point_tags;  // as many as points
  std::size_t higher_order = 0;          // tetrahedra of more than ten nodes, left out
  std::size_t others = 0;                // cells of other kinds, left out
};

// Each adds to `problems` what is malformed and then gives something to be thrown away.
RawMesh ReadGmsh(std::string_view bytes, Problems& problems);
RawMesh ReadVtu(std::string_view bytes, Problems& problems);
RawMesh ReadVtkLegacy(std::string_view bytes, Problems& problems);
RawMesh ReadMedit(std::string_view bytes, Problems& problems);
RawMesh ReadTetgen(std::string_view node_bytes, std::string_view element_bytes, Problems& problems);

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_MESH_READERS_H_
