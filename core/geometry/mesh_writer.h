#ifndef FASCICLE_CORE_GEOMETRY_MESH_WRITER_H_
#define FASCICLE_CORE_GEOMETRY_MESH_WRITER_H_

#include <cstdint>
#include <stop_token>
#include <string>
#include <vector>

#include "core/geometry/tet_mesh.h"

namespace fascicle {

// The mesh as a Gmsh file, version 2.2, ASCII. ReadMesh restores the same nodes (to the last bit), tetrahedra, tagged
// triangles and nodes, tags and curved edges. An element that belongs to several regions is written once for each, as
// Gmsh does. Tetrahedra have ten nodes if any edge is curved. Throws Stopped after a stop request.
std::string GmshText(const TetMesh& mesh, const std::vector<TagName>& names, const std::stop_token& stop = {});

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_MESH_WRITER_H_
