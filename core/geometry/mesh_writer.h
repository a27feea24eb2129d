#ifndef FASCICLE_CORE_GEOMETRY_MESH_WRITER_H_
#define FASCICLE_CORE_GEOMETRY_MESH_WRITER_H_

#include <cstdint>
#include <stop_token>
#include <string>
#include <vector>

#include "core/geometry/tet_mesh.h"

namespace fascicle {

// A name for a physical tag.
struct TagName {
  int dimension = 2;  // 2: of triangles, 3: of tetrahedra
  std::int32_t tag = 0;
  std::string name;  // without quotes
};

// The mesh as a Gmsh file, version 2.2, ASCII. ReadMesh restores the same nodes (to the last bit), tetrahedra, tagged
// triangles and tags. A triangle that belongs to several regions is written once for each. Curved edges are not
// written. Throws Stopped after a stop request.
std::string GmshText(const TetMesh& mesh, const std::vector<TagName>& names, const std::stop_token& stop = {});

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_MESH_WRITER_H_
