#include "core/geometry/region.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "core/geometry/faces.h"
#include "core/geometry/triangle_distance.h"

namespace fascicle {
namespace {

constexpr double kRoundOff = 1e-9;  // of the diagonal; for angles in [rad]

double Diagonal(const TetMesh& mesh) {
  if (mesh.nodes.empty()) return 0;
  Vec3 lowest = mesh.nodes[0], highest = mesh.nodes[0];
  for (const Vec3& node : mesh.nodes) {
    lowest = lowest.cwiseMin(node);
    highest = highest.cwiseMax(node);
  }
  return (highest - lowest).norm();
}

// Nodes that are `inside`, the surface triangles between them, and the tetrahedra with their centroid inside.
template <class Inside>
void SelectNodes(const TetMesh& mesh, const std::vector<Triangle>& surface, const Inside& inside, Region& region) {
  std::vector<char> chosen(mesh.nodes.size());
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    chosen[n] = inside(mesh.nodes[n]);
    if (chosen[n]) region.nodes.push_back(static_cast<std::int32_t>(n));
  }
  for (const Triangle& triangle : surface) {
    if (chosen[triangle[0]] && chosen[triangle[1]] && chosen[triangle[2]]) region.triangles.push_back(triangle);
  }
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    const auto& [a, b, c, d] = mesh.tetrahedra[t];
    const Vec3 centroid = 0.25 * (mesh.nodes[a] + mesh.nodes[b] + mesh.nodes[c] + mesh.nodes[d]);
    if (inside(centroid)) region.tetrahedra.push_back(static_cast<std::int32_t>(t));
  }
}

// Appends the nodes of a cell; SortNodes must follow.
template <class Cell>
void AddNodes(const Cell& cell, Region& region) {
  region.nodes.insert(region.nodes.end(), cell.begin(), cell.end());
}

void SortNodes(Region& region) {
  std::sort(region.nodes.begin(), region.nodes.end());
  region.nodes.erase(std::unique(region.nodes.begin(), region.nodes.end()), region.nodes.end());
}

struct Select {
  const TetMesh& mesh;
  const std::vector<Triangle>& surface;
  Region& region;

  // The file lists triangles in any orientation, and perhaps inside of the body: those of the surface are taken from
  // there.
  void operator()(const TagSelector& selector) const {
    std::vector<Triangle> chosen;
    for (std::size_t i = 0; i < mesh.triangle_tags.size(); ++i) {
      if (mesh.triangle_tags[i] != selector.tag) continue;
      AddNodes(mesh.tagged_triangles[i], region);
      chosen.push_back(Ascending(mesh.tagged_triangles[i]));
    }
    for (std::size_t t = 0; t < mesh.tetrahedron_tags.size(); ++t) {
      if (mesh.tetrahedron_tags[t] == selector.tag) region.tetrahedra.push_back(static_cast<std::int32_t>(t));
    }
    if (chosen.empty() && region.tetrahedra.empty()) return SelectTaggedNodes(selector.tag);
    if (chosen.empty()) {
      for (const std::int32_t t : region.tetrahedra) {
        AddNodes(mesh.tetrahedra[t], region);
        for (int side = 0; side < 4; ++side) chosen.push_back(Ascending(OutwardTriangle(mesh.tetrahedra[t], side)));
      }
    }
    SortNodes(region);
    std::sort(chosen.begin(), chosen.end());
    for (const Triangle& triangle : surface) {
      if (std::binary_search(chosen.begin(), chosen.end(), Ascending(triangle))) region.triangles.push_back(triangle);
    }
  }

  void SelectTaggedNodes(std::int32_t tag) const {
    std::vector<char> chosen(mesh.nodes.size());
    for (std::size_t p = 0; p < mesh.node_tags.size(); ++p) {
      if (mesh.node_tags[p] != tag) continue;
      region.nodes.push_back(mesh.tagged_nodes[p]);
      chosen[mesh.tagged_nodes[p]] = 1;
    }
    SortNodes(region);
    for (const Triangle& triangle : surface) {
      if (chosen[triangle[0]] && chosen[triangle[1]] && chosen[triangle[2]]) region.triangles.push_back(triangle);
    }
  }

  void operator()(const PlaneSelector& selector) const {
    const double tolerance = kRoundOff * Diagonal(mesh);
    const Vec3 normal = selector.normal.normalized();
    SelectNodes(
        mesh, surface, [&](const Vec3& x) { return (x - selector.point).dot(normal) >= -tolerance; }, region);
  }

  void operator()(const BoxSelector& selector) const {
    const double tolerance = kRoundOff * Diagonal(mesh);
    const auto inside = [&](const Vec3& x) {
      return ((x - selector.min).array() >= -tolerance).all() && ((selector.max - x).array() >= -tolerance).all();
    };
    SelectNodes(mesh, surface, inside, region);
  }

  void operator()(const SphereSelector& selector) const {
    const double tolerance = kRoundOff * Diagonal(mesh);
    const auto inside = [&](const Vec3& x) { return (x - selector.center).norm() <= selector.radius + tolerance; };
    SelectNodes(mesh, surface, inside, region);
  }

  void operator()(const SideSelector& selector) const {
    for (const Triangle& triangle : surface) {
      const Vec3& origin = mesh.nodes[triangle[0]];
      const Vec3 normal = (mesh.nodes[triangle[1]] - origin).cross(mesh.nodes[triangle[2]] - origin);
      // atan2 keeps the angle exact near 0 and pi, where the arc cosine loses half of the digits.
      const double angle = std::atan2(normal.cross(selector.direction).norm(), normal.dot(selector.direction));
      if (normal.isZero(0) || angle > selector.max_angle + kRoundOff) continue;
      region.triangles.push_back(triangle);
      AddNodes(triangle, region);
    }
    SortNodes(region);
    if (selector.depth > 0 && !region.triangles.empty()) SelectLayer(selector.depth);
  }

  // The tetrahedra with their centroid within a distance of the region's triangles.
  void SelectLayer(double depth) const {
    const TriangleDistance distance(mesh.nodes, region.triangles);
    const double reach = depth + kRoundOff * Diagonal(mesh);
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
      const auto& [a, b, c, d] = mesh.tetrahedra[t];
      const Vec3 centroid = 0.25 * (mesh.nodes[a] + mesh.nodes[b] + mesh.nodes[c] + mesh.nodes[d]);
      if (distance.IsWithin(centroid, reach)) region.tetrahedra.push_back(static_cast<std::int32_t>(t));
    }
  }
};

template <class Items>
Items Common(Items first, Items second) {
  std::sort(first.begin(), first.end());
  std::sort(second.begin(), second.end());
  Items common;
  std::set_intersection(first.begin(), first.end(), second.begin(), second.end(), std::back_inserter(common));
  return common;
}

}  // namespace

Region SelectRegion(const TetMesh& mesh, const std::vector<Triangle>& surface, std::string name,
                    const Selector& selector) {
  Region region;
  region.name = std::move(name);
  std::visit(Select{mesh, surface, region}, selector);
  return region;
}

Region Intersection(const Region& first, const Region& second) {
  return {first.name, Common(first.nodes, second.nodes), Common(first.triangles, second.triangles),
          Common(first.tetrahedra, second.tetrahedra)};
}

}  // namespace fascicle
