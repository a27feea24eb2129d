#ifndef FASCICLE_CORE_GEOMETRY_TRIANGLE_MESH_H_
#define FASCICLE_CORE_GEOMETRY_TRIANGLE_MESH_H_

#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/problems.h"
#include "core/geometry/tet_mesh.h"

namespace fascicle {

// A surface of triangles; counter-clockwise seen from outside if it is closed. Lengths are in any one unit.
struct TriangleMesh {
  std::vector<Vec3> nodes;
  std::vector<Triangle> triangles;
};

// The enclosed volume, by the divergence theorem. Regions enclosed twice count twice. 0 without triangles.
double EnclosedVolume(const TriangleMesh& surface);
double Area(const TriangleMesh& surface);
// Diagonal of the nodes' bounding box.
double Diagonal(const std::vector<Vec3>& nodes);

// Reads a surface from the bytes of an STL (ASCII and binary), OBJ, PLY (ASCII and binary) or VTK XML (.vtp) file; the
// extension of `name`, in any case, selects the format. Polygons of any simple shape are split into triangles
// (ear_clipping.h). STL corners at the same position become one node. Flaws in spite of which a file is read, such as
// bytes after the last triangle, are added to `notes`. Malformed input never crashes, hangs or allocates more than a
// small multiple of the file's size. It adds to `problems` (with empty paths and line numbers in the message) and
// returns nothing. Throws Stopped after a stop request.
std::optional<TriangleMesh> ReadSurface(std::string_view name, std::string_view bytes, Problems& problems,
                                        const std::stop_token& stop = {}, std::vector<std::string>* notes = nullptr);

// The extensions that ReadSurface accepts, for messages: ".stl, .obj, ...".
std::string KnownSurfaceExtensions();

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_TRIANGLE_MESH_H_
