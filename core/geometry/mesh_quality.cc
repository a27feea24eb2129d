#include "core/geometry/mesh_quality.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "core/base/stop.h"
#include "core/geometry/faces.h"

namespace fascicle {

Cosines DihedralCosines(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 ab = b - a, ac = c - a, ad = d - a;
  // Inward normals of the faces opposite to b, c, d and a.
  const std::array<Vec3, 4> normals = {ac.cross(ad), ad.cross(ab), ab.cross(ac),
                                       Vec3(-(ac.cross(ad) + ad.cross(ab) + ab.cross(ac)))};
  if (!(normals[0].dot(ab) > 0)) return {-2, 2};
  std::array<double, 4> scale;
  for (int i = 0; i < 4; ++i) scale[i] = 1 / normals[i].norm();
  Cosines cosines{1, -1};
  for (int i = 0; i < 4; ++i) {
    for (int j = i + 1; j < 4; ++j) {
      const double cosine = -normals[i].dot(normals[j]) * scale[i] * scale[j];
      cosines.lowest = std::min(cosines.lowest, cosine);
      cosines.highest = std::max(cosines.highest, cosine);
    }
  }
  return cosines;
}

AngleFigures MeasureAngles(const TetMesh& mesh, const std::stop_token& stop) {
  AngleFigures figures;
  if (mesh.tetrahedra.empty()) return figures;
  std::vector<double> smallest(mesh.tetrahedra.size());
  double lowest = 1;
  for (std::size_t t = 0; t < smallest.size(); ++t) {
    ThrowIfStopped(stop);
    const auto& [a, b, c, d] = mesh.tetrahedra[t];
    const Cosines cosines = DihedralCosines(mesh.nodes[a], mesh.nodes[b], mesh.nodes[c], mesh.nodes[d]);
    smallest[t] = std::acos(std::clamp(cosines.highest, -1.0, 1.0));
    lowest = std::min(lowest, cosines.lowest);
  }
  figures.smallest = *std::min_element(smallest.begin(), smallest.end());
  figures.largest = std::acos(std::clamp(lowest, -1.0, 1.0));
  const auto middle = smallest.begin() + static_cast<std::ptrdiff_t>(smallest.size() / 2);
  std::nth_element(smallest.begin(), middle, smallest.end());
  figures.median = *middle;
  return figures;
}

std::vector<std::int32_t> FaceConnectedParts(const TetMesh& mesh, const std::stop_token& stop) {
  std::vector<std::int32_t> parent(mesh.tetrahedra.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](std::int32_t t) {
    while (parent[t] != t) t = parent[t] = parent[parent[t]];
    return t;
  };
  const std::vector<Face> faces = SortedFaces(mesh.tetrahedra, stop);
  for (std::size_t i = 1; i < faces.size(); ++i) {
    if (faces[i].nodes != faces[i - 1].nodes) continue;
    const auto a = root(static_cast<std::int32_t>(faces[i].side / 4));
    const auto b = root(static_cast<std::int32_t>(faces[i - 1].side / 4));
    parent[std::max(a, b)] = std::min(a, b);
  }
  std::vector<std::int32_t> part(parent.size());
  std::int32_t count = 0;
  for (std::size_t t = 0; t < part.size(); ++t) {
    const std::int32_t r = root(static_cast<std::int32_t>(t));
    part[t] = r == static_cast<std::int32_t>(t) ? count++ : part[r];
  }
  return part;
}

}  // namespace fascicle
