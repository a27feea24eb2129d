#ifndef FASCICLE_CORE_GEOMETRY_MESH_READERS_H_
#define FASCICLE_CORE_GEOMETRY_MESH_READERS_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/problems.h"
#include "core/geometry/mesh_io.h"
#include "core/geometry/solid_cells.h"
#include "core/geometry/tet_mesh.h"

namespace fascicle {

// A hexahedron, wedge or pyramid.
struct RawSolid {
  SolidShape shape = SolidShape::kHexahedron;
  std::array<std::int64_t, 8> nodes = {};  // the first CornersOf(shape)
  // Of hexahedra of 20 nodes and more: the mid-edge nodes in the order of kHexEdges.
  std::optional<std::array<std::int64_t, 12>> middles = {};
};

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
  std::vector<RawSolid> solids;
  std::vector<std::int64_t> solid_tags;  // one for each solid
  std::vector<std::array<std::int64_t, 4>> quads;
  std::vector<std::int64_t> quad_tags;  // one for each quadrilateral
  // Index and tag of tetrahedra and solids with several tags, for all but the first.
  std::vector<std::array<std::int64_t, 2>> further_tags, further_solid_tags;
  std::size_t curved_solids = 0;  // solids with mid-edge nodes
  std::size_t inner_nodes = 0;    // nodes in the middle of the sides of hexahedra and inside, which are left out
  std::size_t higher_order = 0;   // tetrahedra of more than ten nodes, skipped
  std::size_t other_solids = 0;   // solids of other shapes, such as polyhedra, skipped
  std::size_t others = 0;         // cells of other kinds, skipped
  std::vector<TagName> names;
  std::vector<std::string> notes;
  std::vector<std::array<std::int32_t, 2>> node_places;  // as in MeshRemarks, set by FinishMesh
};

// Looks up the nodes, splits or keeps solids as wanted, and makes a mesh of what a reader found. Adds to `problems`
// what prevents that, and to `remarks`, if given, the names and notes.
std::optional<TetMesh> FinishMesh(RawMesh raw, Solids solids, Problems& problems, const std::stop_token& stop = {},
                                  MeshRemarks* remarks = nullptr);

// Each adds malformed input to `problems`; its result must then be discarded. Each throws Stopped after a stop request.
RawMesh ReadGmsh(std::string_view bytes, const std::stop_token& stop, Problems& problems);
RawMesh ReadVtu(std::string_view bytes, const std::stop_token& stop, Problems& problems);
RawMesh ReadVtkLegacy(std::string_view bytes, const std::stop_token& stop, Problems& problems);
RawMesh ReadMedit(std::string_view bytes, const std::stop_token& stop, Problems& problems);
RawMesh ReadAbaqus(std::string_view bytes, const std::stop_token& stop, Problems& problems);
RawMesh ReadTetgen(std::string_view node_bytes, std::string_view element_bytes, const std::stop_token& stop,
                   Problems& problems);

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_MESH_READERS_H_
