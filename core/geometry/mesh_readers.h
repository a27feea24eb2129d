#ifndef FASCICLE_CORE_GEOMETRY_MESH_READERS_H_
#define FASCICLE_CORE_GEOMETRY_MESH_READERS_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <stop_token>
#include <string_view>
#include <vector>

#include "core/base/problems.h"
#include "core/geometry/tet_mesh.h"

namespace fascicle {

// A mesh as stored in its file, before node numbers are looked up. Filled by the readers.
struct RawMesh {
  // Node numbers; empty when the nodes are numbered consecutively from `first_node`.
  std::vector<std::int64_t> node_numbers;
  std::int64_t first_node = 0;
  std::vector<Vec3> nodes;
  std::vector<std::array<std::int64_t, 4>> tetrahedra;
  // Mid-edge nodes of ten-node tetrahedra, in the order of kTetEdges: one entry for each tetrahedron, or none at all.
  std::vector<std::array<std::int64_t, 6>> middles;
  std::vector<std::int64_t> tetrahedron_tags;  // one for each tetrahedron, 0 where it has none
  std::vector<std::array<std::int64_t, 3>> triangles;
  std::vector<std::int64_t> triangle_tags;  // one for each triangle
  std::vector<std::array<std::int64_t, 1>> points;
  std::vector<std::int64_t> point_tags;  // one for each point
  std::size_t higher_order = 0;          // tetrahedra of more than ten nodes, skipped
  std::size_t others = 0;                // cells of other kinds, skipped
};

// Each adds malformed input to `problems`; its result must then be discarded. Each throws Stopped after a stop request.
RawMesh ReadGmsh(std::string_view bytes, const std::stop_token& stop, Problems& problems);
RawMesh ReadVtu(std::string_view bytes, const std::stop_token& stop, Problems& problems);
RawMesh ReadVtkLegacy(std::string_view bytes, const std::stop_token& stop, Problems& problems);
RawMesh ReadMedit(std::string_view bytes, const std::stop_token& stop, Problems& problems);
RawMesh ReadTetgen(std::string_view node_bytes, std::string_view element_bytes, const std::stop_token& stop,
                   Problems& problems);

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_MESH_READERS_H_
