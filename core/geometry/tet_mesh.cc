#include "core/geometry/tet_mesh.h"

#include <Eigen/Geometry>

#include <algorithm>

#include "core/geometry/faces.h"
#include "core/geometry/solid_cells.h"

namespace fascicle {

double SignedVolume(const TetMesh& mesh, std::size_t tetrahedron) {
  const auto& [a, b, c, d] = mesh.tetrahedra[tetrahedron];
  const Vec3& origin = mesh.nodes[a];
  return (mesh.nodes[b] - origin).cross(mesh.nodes[c] - origin).dot(mesh.nodes[d] - origin) / 6;
}

Vec3 Centroid(const TetMesh& mesh, std::size_t tetrahedron) {
  const auto& [a, b, c, d] = mesh.tetrahedra[tetrahedron];
  return (mesh.nodes[a] + mesh.nodes[b] + mesh.nodes[c] + mesh.nodes[d]) / 4;
}

Vec3 ElementCentroid(const TetMesh& mesh, std::size_t element) {
  if (mesh.hexahedra.empty()) return Centroid(mesh, element);
  const Hexahedron& hexahedron = mesh.hexahedra[element];
  const auto solid = SolidOf(hexahedron);
  const auto corners = solid ? solid->corners() : std::span<const std::int32_t>(hexahedron);
  Vec3 sum = Vec3::Zero();
  for (const std::int32_t n : corners) sum += mesh.nodes[n];
  return sum / static_cast<double>(corners.size());
}

double TotalVolume(const TetMesh& mesh) {
  double volume = 0;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) volume += SignedVolume(mesh, t);
  return volume;
}

std::vector<Triangle> BoundaryTriangles(const TetMesh& mesh, const std::stop_token& stop) {
  const std::vector<Face> faces = SortedFaces(mesh.tetrahedra, stop);
  std::vector<std::int64_t> boundary;  // Face::side
  for (std::size_t i = 0; i < faces.size();) {
    std::size_t end = i + 1;
    while (end < faces.size() && faces[end].nodes == faces[i].nodes) ++end;
    if (end == i + 1) boundary.push_back(faces[i].side);
    i = end;
  }
  std::sort(boundary.begin(), boundary.end());
  std::vector<Triangle> triangles;
  triangles.reserve(boundary.size());
  for (const std::int64_t side : boundary) triangles.push_back(OutwardTriangle(mesh.tetrahedra[side / 4], side % 4));
  return triangles;
}

}  // namespace fascicle
