#ifndef FASCICLE_CORE_GEOMETRY_TRIANGLE_MESH_H_
#define FASCICLE_CORE_GEOMETRY_TRIANGLE_MESH_H_

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/problems.h"
#include "core/geometry/tet_mesh.h"

namespace fascicle {

// A surface of triangles, counter-clockwise seen from outside where it is closed. Lengths in any one unit.
struct TriangleMesh {
  std::vector<Vec3> nodes;
  std::vector<Triangle> triangles;
};

// What the surface encloses, by the divergence theorem; what is enclosed twice counts twice. 0 without triangles.
double EnclosedVolume(const TriangleMesh& surface);
double Area(const TriangleMesh& surface);
// Length of the diagonal of the box around the nodes.
double Diagonal(const std::vector<Vec3>& nodes);

// Reads a surface from the bytes of an STL (ASCII and binary), OBJ, PLY (ASCII and binary) or VTK XML (.vtp) file; the
// extension of `name` tells which. Polygons are split into triangles; STL corners at the same place become one node.
// Malformed input never crashes, hangs or allocates more than a small multiple of the file's size: it adds to
// `problems` (paths are left empty; line numbers stand in the message) and gives nothing.
std::optional<TriangleMesh> ReadSurface(std::string_view name, std::string_view bytes, Problems& problems);

// The extensions that ReadSurface knows, for messages: ".stl, .obj, ...".
std::string KnownSurfaceExtensions();

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_TRIANGLE_MESH_H_
