#ifndef FASCICLE_CLIENT_IMPORT_MESH_WRITER_H_
#define FASCICLE_CLIENT_IMPORT_MESH_WRITER_H_

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/types.h"
#include "core/geometry/tet_mesh.h"

namespace fascicle::client {

// A named part of a mesh with its own tag.
struct TaggedPart {
  std::string name;
  int dimension = 3;  // 0: nodes, 2: triangles, 3: elements
  std::int32_t tag = 0;
  std::vector<std::int32_t> nodes;  // dimension 0
  std::vector<Triangle> triangles;  // dimension 2
};

struct MeshToWrite {
  std::vector<Vec3> nodes;
  std::vector<Tetrahedron> tetrahedra;
  std::vector<Hexahedron> hexahedra;                 // in place of the tetrahedra
  std::vector<std::array<std::int32_t, 6>> middles;  // in the order of kTetEdges; empty for four nodes
  std::vector<std::int32_t> tags;                    // of the tetrahedra or hexahedra
  std::vector<TaggedPart> parts;
};

// The text of a Gmsh 2.2 file. Coordinates read back exactly.
std::string GmshText(const MeshToWrite& mesh);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_IMPORT_MESH_WRITER_H_
