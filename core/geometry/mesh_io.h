#ifndef FASCICLE_CORE_GEOMETRY_MESH_IO_H_
#define FASCICLE_CORE_GEOMETRY_MESH_IO_H_

#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/problems.h"
#include "core/geometry/tet_mesh.h"

namespace fascicle {

// What becomes of hexahedra, wedges and pyramids. kKeep: a mesh of hexahedra alone is kept as such, all others but
// tetrahedra are refused. kSplit: they are split into tetrahedra.
enum class Solids { kKeep, kSplit };

// The bytes of a mesh file. The views must stay valid during the call only.
struct MeshFile {
  std::string_view name;  // its extension, in any case, gives the format: .msh .vtu .vtk .mesh .node .inp
  std::string_view bytes;
  std::string_view element_bytes = {};  // TetGen only: the bytes of the .ele file
  Solids solids = Solids::kKeep;        // what becomes of hexahedra, wedges and pyramids
};

// What a file says besides its mesh.
struct MeshRemarks {
  std::vector<TagName> names;      // of physical tags
  std::vector<std::string> notes;  // what was left out, or read in spite of a flaw
  // Of a mesh of second order: where each node of the file is, in its order and without those that were left out: at a
  // node of the mesh, given twice, or in the middle between two. Empty for other meshes.
  std::vector<std::array<std::int32_t, 2>> node_places;
};

// Reads tetrahedra and tagged triangles and nodes from Gmsh 2.2/4.1 ASCII, VTK XML (.vtu: ascii, inline and appended,
// raw or base64, zlib-compressed or not), VTK legacy (ascii and binary), MEDIT ASCII, TetGen, and Abaqus. Lines and
// surface cells without tags are skipped; solids of other shapes are treated as the file's `solids` says. Nodes
// without a tetrahedron are left out, with a note. The file's node numbers are kept where they are contiguous; TetGen
// files may count from 0 or 1. Coordinates stay in the file's unit; tetrahedra keep the file's orientation, and those
// of a split solid have positive volumes. Malformed input never crashes, hangs or allocates more than a small multiple
// of the file's size. It adds to `problems` (with empty paths and line numbers in the message) and returns nothing.
// Throws Stopped after a stop request.
std::optional<TetMesh> ReadMesh(const MeshFile& file, Problems& problems, const std::stop_token& stop = {},
                                MeshRemarks* remarks = nullptr);

// The extensions that ReadMesh accepts, for messages: ".msh, .vtu, ...".
std::string KnownMeshExtensions();

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_MESH_IO_H_
