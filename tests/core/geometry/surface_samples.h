#ifndef FASCICLE_TESTS_CORE_GEOMETRY_SURFACE_SAMPLES_H_
#define FASCICLE_TESTS_CORE_GEOMETRY_SURFACE_SAMPLES_H_

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "core/geometry/shapes.h"
#include "core/geometry/triangle_mesh.h"

namespace fascicle {

// The surface of the unit corner tetrahedron as a file.
struct SurfaceSample {
  std::string name;
  std::string bytes;
};

inline constexpr const char* kAsciiStl = R"(solid corner
facet normal 0 0 -1
 outer loop
  vertex 0 0 0
  vertex 0 1 0
  vertex 1 0 0
 endloop
endfacet
facet normal 0 -1 0
 outer loop
  vertex 0 0 0
  vertex 1 0 0
  vertex 0 0 1
 endloop
endfacet
facet normal nan nan nan
 outer loop
  vertex 1 0 0
  vertex 0 1 0
  vertex 0 0 1
 endloop
endfacet
facet normal -1 0 0
 outer loop
  vertex 0 0 0
  vertex 0 0 1
  vertex 0 1 0
 endloop
endfacet
endsolid corner
)";

inline constexpr const char* kObj = R"(# a comment
mtllib none.mtl
v 0 0 0
v 0 1 0 0.5 0.5 0.5
v 1 0 0
vn 0 0 1
v 0 0 1
f 1 2 3
f 1/1 3/1 4/1
f 3//1 2//1 4//1
f -4 -1 -3
)";

inline constexpr const char* kAsciiPly = R"(ply
format ascii 1.0
comment a corner
element vertex 4
property float x
property float y
property float z
property uchar red
element edge 1
property int vertex1
property int vertex2
element face 4
property list uchar int vertex_indices
end_header
0 0 0 255
0 1 0 255
1 0 0 255
0 0 1 255
0 1
3 0 1 2
3 0 2 3
3 2 1 3
3 0 3 1
)";

inline constexpr const char* kVtp = R"(<?xml version="1.0"?>
<VTKFile type="PolyData" version="0.1" byte_order="LittleEndian">
  <PolyData>
    <Piece NumberOfPoints="4" NumberOfVerts="0" NumberOfLines="0" NumberOfStrips="0" NumberOfPolys="4">
      <Points><DataArray type="Float32" NumberOfComponents="3" format="ascii">0 0 0 0 1 0 1 0 0 0 0 1</DataArray></Points>
      <Polys>
        <DataArray type="Int32" Name="connectivity" format="ascii">0 1 2 0 2 3 2 1 3 0 3 1</DataArray>
        <DataArray type="Int32" Name="offsets" format="ascii">3 6 9 12</DataArray>
      </Polys>
    </Piece>
  </PolyData>
</VTKFile>
)";

template <class T>
void AppendBytes(T value, bool big_endian, std::string& text) {
  std::string bytes(reinterpret_cast<const char*>(&value), sizeof(value));
  if (big_endian) bytes = std::string(bytes.rbegin(), bytes.rend());
  text += bytes;
}

inline TriangleMesh CornerSurface() {
  return {{{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1}}, {{0, 1, 2}, {0, 2, 3}, {2, 1, 3}, {0, 3, 1}}};
}

inline std::string BinaryStl(const TriangleMesh& surface) {
  std::string bytes = "solid binary files may begin like this";
  bytes.resize(80, ' ');
  AppendBytes(static_cast<std::uint32_t>(surface.triangles.size()), false, bytes);
  for (const Triangle& triangle : surface.triangles) {
    for (int i = 0; i < 3; ++i) AppendBytes(0.0F, false, bytes);
    for (const std::int32_t n : triangle) {
      for (const double x : surface.nodes[n]) AppendBytes(static_cast<float>(x), false, bytes);
    }
    bytes += std::string(2, '\0');
  }
  return bytes;
}

inline std::string BinaryPly(const TriangleMesh& surface, bool big_endian) {
  std::string bytes = "ply\nformat binary_" + std::string(big_endian ? "big" : "little") + "_endian 1.0\n";
  bytes += "element vertex " + std::to_string(surface.nodes.size()) +
           "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
           std::to_string(surface.triangles.size()) + "\nproperty list uchar uint vertex_index\nend_header\n";
  for (const Vec3& node : surface.nodes) {
    for (const double x : node) AppendBytes(x, big_endian, bytes);
  }
  for (const Triangle& triangle : surface.triangles) {
    AppendBytes(std::uint8_t{3}, big_endian, bytes);
    for (const std::int32_t n : triangle) AppendBytes(static_cast<std::uint32_t>(n), big_endian, bytes);
  }
  return bytes;
}

inline std::vector<SurfaceSample> SurfaceSamples() {
  return {{"ascii.stl", kAsciiStl},
          {"binary.stl", BinaryStl(CornerSurface())},
          {"corner.obj", kObj},
          {"ascii.ply", kAsciiPly},
          {"little.ply", BinaryPly(CornerSurface(), false)},
          {"big.ply", BinaryPly(CornerSurface(), true)},
          {"corner.vtp", kVtp}};
}

// The boundary of a mesh, with only its own nodes.
inline TriangleMesh SurfaceOf(const TetMesh& mesh) {
  TriangleMesh surface;
  std::vector<std::int32_t> number(mesh.nodes.size(), -1);
  for (Triangle triangle : BoundaryTriangles(mesh)) {
    for (std::int32_t& n : triangle) {
      if (number[n] < 0) {
        number[n] = static_cast<std::int32_t>(surface.nodes.size());
        surface.nodes.push_back(mesh.nodes[n]);
      }
      n = number[n];
    }
    surface.triangles.push_back(triangle);
  }
  return surface;
}

inline TriangleMesh Moved(TriangleMesh surface, const Vec3& by) {
  for (Vec3& node : surface.nodes) node += by;
  return surface;
}

inline TriangleMesh InsideOut(TriangleMesh surface) {
  for (Triangle& triangle : surface.triangles) std::swap(triangle[1], triangle[2]);
  return surface;
}

// Both surfaces in one.
inline TriangleMesh Joined(TriangleMesh a, const TriangleMesh& b) {
  const auto first = static_cast<std::int32_t>(a.nodes.size());
  a.nodes.insert(a.nodes.end(), b.nodes.begin(), b.nodes.end());
  for (const auto& [i, j, k] : b.triangles) a.triangles.push_back({first + i, first + j, first + k});
  return a;
}

// Without the triangles with a corner closer than `radius` to a point.
inline TriangleMesh WithHole(TriangleMesh surface, const Vec3& point, double radius) {
  std::erase_if(surface.triangles, [&](const Triangle& t) {
    return std::any_of(t.begin(), t.end(), [&](std::int32_t n) { return (surface.nodes[n] - point).norm() < radius; });
  });
  return surface;
}

}  // namespace fascicle

#endif  // FASCICLE_TESTS_CORE_GEOMETRY_SURFACE_SAMPLES_H_
