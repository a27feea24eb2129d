#include "core/geometry/region.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <type_traits>
#include <utility>

#include "core/geometry/faces.h"
#include "core/geometry/solid_cells.h"
#include "core/geometry/triangle_distance.h"
#include "core/geometry/triangle_mesh.h"

namespace fascicle {
namespace {

constexpr double kRegionRoundOff = 1e-9;  // relative to the diagonal; for angles in [rad]

std::vector<Triangle> TrianglesOf(const std::vector<Quad>& quads) {
  std::vector<Triangle> triangles;
  for (const Quad& q : quads) {
    triangles.push_back({q[0], q[1], q[2]});
    if (q[3] != q[2]) triangles.push_back({q[0], q[2], q[3]});
  }
  return triangles;
}

template <class FaceNodes>
Vec3 NormalAtFirst(const std::vector<Vec3>& X, const FaceNodes& face) {
  return (X[face[1]] - X[face[0]]).cross(X[face[2]] - X[face[0]]);
}

// Access to one kind of mesh: its elements and the faces of its boundary.
struct Tetrahedra {
  using Surface = std::vector<Triangle>;
  const TetMesh& mesh;
  const Surface& surface;

  const std::vector<Tetrahedron>& elements() const { return mesh.tetrahedra; }
  const std::vector<std::int32_t>& tags() const { return mesh.tetrahedron_tags; }
  const std::vector<std::array<std::int32_t, 2>>& further_tags() const { return mesh.further_tags; }
  static const Surface& Triangles(const Surface& faces) { return faces; }
  Vec3 NormalOf(const Triangle& face) const { return NormalAtFirst(mesh.nodes, face); }
  static void AddFace(const Triangle& face, Region& region) { region.triangles.push_back(face); }
  static const Surface& FacesOf(const Region& region) { return region.triangles; }
  static std::array<Triangle, 4> SidesOf(const Tetrahedron& tet) {
    return {OutwardTriangle(tet, 0), OutwardTriangle(tet, 1), OutwardTriangle(tet, 2), OutwardTriangle(tet, 3)};
  }
};

// Hexahedra, for all selectors but tags. SelectRegion adds the triangles of the sides.
struct Hexahedra {
  using Surface = std::vector<Quad>;
  const TetMesh& mesh;
  const Surface& surface;

  const std::vector<Hexahedron>& elements() const { return mesh.hexahedra; }
  static std::vector<Triangle> Triangles(const Surface& faces) { return TrianglesOf(faces); }
  // Of the diagonals: the mean over a side that is not flat.
  Vec3 NormalOf(const Quad& face) const {
    const std::vector<Vec3>& X = mesh.nodes;
    return (X[face[2]] - X[face[0]]).cross(X[face[3]] - X[face[1]]);
  }
  static void AddFace(const Quad& face, Region& region) { region.sides.push_back(face); }
  static const Surface& FacesOf(const Region& region) { return region.sides; }
};

struct Bricks {
  using Surface = std::vector<Quad>;
  const BrickMesh& mesh;
  const Surface& surface;

  const std::vector<Brick>& elements() const { return mesh.bricks; }
  const std::vector<std::int32_t>& tags() const { return mesh.labels; }
  static std::vector<Triangle> Triangles(const Surface& faces) { return TrianglesOf(faces); }
  Vec3 NormalOf(const Quad& face) const { return NormalAtFirst(mesh.nodes, face); }
  static void AddFace(const Quad& face, Region& region) { region.quads.push_back(face); }
  static const Surface& FacesOf(const Region& region) { return region.quads; }
  static std::array<Quad, 6> SidesOf(const Brick& brick) {
    std::array<Quad, 6> sides;
    for (int s = 0; s < 6; ++s) {
      for (int c = 0; c < 4; ++c) sides[s][c] = brick[kBrickSides[s][c]];
    }
    return sides;
  }
};

Vec3 CentroidOf(const std::vector<Vec3>& nodes, const Hexahedron& cell) {
  const auto solid = SolidOf(cell);
  const auto corners = solid ? solid->corners() : std::span<const std::int32_t>(cell);
  Vec3 sum = Vec3::Zero();
  for (const std::int32_t node : corners) sum += nodes[static_cast<std::size_t>(node)];
  return sum / static_cast<double>(corners.size());
}
template <class Cell>
Vec3 CentroidOf(const std::vector<Vec3>& nodes, const Cell& cell) {
  Vec3 sum = Vec3::Zero();
  for (const std::int32_t node : cell) sum += nodes[node];
  return sum / static_cast<double>(cell.size());
}

// A key that is the same for every starting corner and orientation of a face.
template <class FaceNodes>
FaceNodes Sorted(FaceNodes face) {
  std::sort(face.begin(), face.end());
  return face;
}

// Appends the nodes of a cell. Call SortNodes afterwards.
template <class Cell>
void AddNodes(const Cell& cell, Region& region) {
  region.nodes.insert(region.nodes.end(), cell.begin(), cell.end());
}

void SortNodes(Region& region) {
  std::sort(region.nodes.begin(), region.nodes.end());
  region.nodes.erase(std::unique(region.nodes.begin(), region.nodes.end()), region.nodes.end());
}

template <class Cells>
struct Select {
  using FaceNodes = typename Cells::Surface::value_type;
  const Cells cells;
  Region& region;

  void operator()(const TagSelector& selector) const {
    std::vector<FaceNodes> chosen;
    if constexpr (std::is_same_v<Cells, Tetrahedra>) chosen = TaggedTriangles(selector.tag);
    SelectTaggedElements(selector.tag);
    if (chosen.empty() && region.elements.empty()) {
      if constexpr (std::is_same_v<Cells, Tetrahedra>) SelectTaggedNodes(selector.tag);
      return;
    }
    if (chosen.empty()) {
      for (const std::int32_t t : region.elements) {
        AddNodes(cells.elements()[t], region);
        for (const FaceNodes& side : Cells::SidesOf(cells.elements()[t])) chosen.push_back(Sorted(side));
      }
    }
    SortNodes(region);
    std::sort(chosen.begin(), chosen.end());
    for (const FaceNodes& face : cells.surface) {
      if (std::binary_search(chosen.begin(), chosen.end(), Sorted(face))) Cells::AddFace(face, region);
    }
  }

  void operator()(const PlaneSelector& selector) const {
    const double tolerance = kRegionRoundOff * Diagonal(cells.mesh.nodes);
    const Vec3 normal = selector.normal.normalized();
    SelectNodes([&](const Vec3& x) { return (x - selector.point).dot(normal) >= -tolerance; });
  }

  void operator()(const BoxSelector& selector) const {
    const double tolerance = kRegionRoundOff * Diagonal(cells.mesh.nodes);
    SelectNodes([&](const Vec3& x) {
      return ((x - selector.min).array() >= -tolerance).all() && ((selector.max - x).array() >= -tolerance).all();
    });
  }

  void operator()(const SphereSelector& selector) const {
    const double tolerance = kRegionRoundOff * Diagonal(cells.mesh.nodes);
    SelectNodes([&](const Vec3& x) { return (x - selector.center).norm() <= selector.radius + tolerance; });
  }

  void operator()(const SideSelector& selector) const {
    for (const FaceNodes& face : cells.surface) {
      const Vec3 normal = cells.NormalOf(face);
      // atan2 stays accurate near 0 and pi, where the arc cosine loses half of the digits.
      const double angle = std::atan2(normal.cross(selector.direction).norm(), normal.dot(selector.direction));
      if (normal.isZero(0) || angle > selector.max_angle + kRegionRoundOff) continue;
      Cells::AddFace(face, region);
      AddNodes(face, region);
    }
    SortNodes(region);
    if (selector.depth > 0 && !Cells::FacesOf(region).empty()) SelectLayer(selector.depth);
  }

 private:
  void SelectTaggedElements(std::int32_t tag) const {
    for (std::size_t t = 0; t < cells.tags().size(); ++t) {
      if (cells.tags()[t] == tag) region.elements.push_back(static_cast<std::int32_t>(t));
    }
    if constexpr (std::is_same_v<Cells, Tetrahedra>) {
      const std::size_t first = region.elements.size();
      for (const auto& [t, further] : cells.further_tags()) {
        if (further == tag) region.elements.push_back(t);
      }
      if (region.elements.size() > first) std::sort(region.elements.begin(), region.elements.end());
    }
  }

  // Triangles in the file have any orientation and may lie inside of the body. Those on the boundary are taken from the
  // boundary, with its orientation.
  std::vector<Triangle> TaggedTriangles(std::int32_t tag) const {
    const TetMesh& mesh = cells.mesh;
    std::vector<Triangle> tagged;
    for (std::size_t i = 0; i < mesh.triangle_tags.size(); ++i) {
      if (mesh.triangle_tags[i] != tag) continue;
      AddNodes(mesh.tagged_triangles[i], region);
      tagged.push_back(Ascending(mesh.tagged_triangles[i]));
    }
    return tagged;
  }

  void SelectTaggedNodes(std::int32_t tag) const {
    const TetMesh& mesh = cells.mesh;
    std::vector<char> chosen(mesh.nodes.size());
    for (std::size_t p = 0; p < mesh.node_tags.size(); ++p) {
      if (mesh.node_tags[p] != tag) continue;
      region.nodes.push_back(mesh.tagged_nodes[p]);
      chosen[mesh.tagged_nodes[p]] = 1;
    }
    SortNodes(region);
    SelectFacesBetween(chosen);
  }

  void SelectFacesBetween(const std::vector<char>& chosen) const {
    for (const FaceNodes& face : cells.surface) {
      if (std::all_of(face.begin(), face.end(), [&](std::int32_t n) { return chosen[n] != 0; }))
        Cells::AddFace(face, region);
    }
  }

  // Selects the nodes that are `inside`, the boundary faces between them, and the elements with their centroid inside.
  template <class Inside>
  void SelectNodes(const Inside& inside) const {
    const std::vector<Vec3>& nodes = cells.mesh.nodes;
    std::vector<char> chosen(nodes.size());
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      chosen[n] = inside(nodes[n]);
      if (chosen[n]) region.nodes.push_back(static_cast<std::int32_t>(n));
    }
    SelectFacesBetween(chosen);
    for (std::size_t t = 0; t < cells.elements().size(); ++t) {
      if (inside(CentroidOf(nodes, cells.elements()[t]))) region.elements.push_back(static_cast<std::int32_t>(t));
    }
  }

  // Selects the elements with their centroid within a distance of the region's faces.
  void SelectLayer(double depth) const {
    const std::vector<Vec3>& nodes = cells.mesh.nodes;
    const std::vector<Triangle> triangles = Cells::Triangles(Cells::FacesOf(region));
    const TriangleDistance distance(nodes, triangles);
    const double reach = depth + kRegionRoundOff * Diagonal(nodes);
    for (std::size_t t = 0; t < cells.elements().size(); ++t) {
      if (distance.IsWithin(CentroidOf(nodes, cells.elements()[t]), reach))
        region.elements.push_back(static_cast<std::int32_t>(t));
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

// The region with a tag in terms of hexahedra, all of whose tetrahedra have their tag.
void SelectTagged(const TetMesh& mesh, const HexahedralBoundary& boundary, const TagSelector& selector,
                  Region& region) {
  std::vector<Triangle> surface;
  for (const auto& triangles : boundary.triangles) surface.insert(surface.end(), triangles.begin(), triangles.end());
  Select<Tetrahedra>{{mesh, surface}, region}(selector);
  std::vector<Triangle> chosen = std::exchange(region.triangles, {});
  std::sort(chosen.begin(), chosen.end());
  const auto is_chosen = [&](const Triangle& t) { return std::binary_search(chosen.begin(), chosen.end(), t); };
  for (std::size_t i = 0; i < boundary.quads.size(); ++i) {
    if (std::all_of(boundary.triangles[i].begin(), boundary.triangles[i].end(), is_chosen)) {
      region.sides.push_back(boundary.quads[i]);
    }
  }
  const std::vector<std::int32_t> hexahedra = HexahedraOfTetrahedra(mesh);
  for (std::int32_t& element : region.elements) element = hexahedra[static_cast<std::size_t>(element)];
  region.elements.erase(std::unique(region.elements.begin(), region.elements.end()), region.elements.end());
}

}  // namespace

Region SelectRegion(const TetMesh& mesh, const HexahedralBoundary& boundary, std::string name,
                    const Selector& selector) {
  Region region;
  region.name = std::move(name);
  region.selectors = {selector};
  std::visit(
      [&]<class Kind>(const Kind& kind) {
        if constexpr (std::is_same_v<Kind, TagSelector>) {
          SelectTagged(mesh, boundary, kind, region);
        } else {
          Select<Hexahedra>{{mesh, boundary.quads}, region}(kind);
        }
      },
      selector);
  // Both lists have the order of the hexahedra.
  std::size_t next = 0;
  for (std::size_t i = 0; i < boundary.quads.size() && next < region.sides.size(); ++i) {
    if (boundary.quads[i] != region.sides[next]) continue;
    region.triangles.insert(region.triangles.end(), boundary.triangles[i].begin(), boundary.triangles[i].end());
    ++next;
  }
  return region;
}

Region SelectRegion(const TetMesh& mesh, const std::vector<Triangle>& surface, std::string name,
                    const Selector& selector) {
  Region region;
  region.name = std::move(name);
  region.selectors = {selector};
  std::visit(Select<Tetrahedra>{{mesh, surface}, region}, selector);
  return region;
}

Region SelectRegion(const BrickMesh& mesh, const std::vector<Quad>& surface, std::string name,
                    const Selector& selector) {
  Region region;
  region.name = std::move(name);
  region.selectors = {selector};
  std::visit(Select<Bricks>{{mesh, surface}, region}, selector);
  return region;
}

struct RegionPoints::Faces {
  explicit Faces(const Region& region, const std::vector<Vec3>& all) : nodes(all), distance(nodes, region.triangles) {}
  const std::vector<Vec3> nodes;
  const TriangleDistance distance;
};

RegionPoints::RegionPoints(const Region& region, const std::vector<Vec3>& nodes, double slack)
    : selectors_(region.selectors), slack_(slack) {
  const bool has_side = std::any_of(selectors_.begin(), selectors_.end(), [](const Selector& selector) {
    return std::holds_alternative<SideSelector>(selector);
  });
  if (has_side && !region.triangles.empty()) faces_ = std::make_shared<const Faces>(region, nodes);
}

bool RegionPoints::Contain(const Vec3& x) const {
  struct Test {
    const RegionPoints& points;
    const Vec3& x;

    bool operator()(const TagSelector&) const { return false; }
    bool operator()(const PlaneSelector& plane) const {
      return (x - plane.point).dot(plane.normal.normalized()) >= -points.slack_;
    }
    bool operator()(const BoxSelector& box) const {
      return ((x - box.min).array() >= -points.slack_).all() && ((box.max - x).array() >= -points.slack_).all();
    }
    bool operator()(const SphereSelector& sphere) const {
      return (x - sphere.center).norm() <= sphere.radius + points.slack_;
    }
    bool operator()(const SideSelector& side) const {
      return points.faces_ && points.faces_->distance.IsWithin(x, side.depth + points.slack_);
    }
  };
  return !selectors_.empty() && std::all_of(selectors_.begin(), selectors_.end(), [&](const Selector& selector) {
    return std::visit(Test{*this, x}, selector);
  });
}

Region Intersection(const Region& first, const Region& second) {
  std::vector<Selector> selectors = first.selectors;
  selectors.insert(selectors.end(), second.selectors.begin(), second.selectors.end());
  return {first.name,
          Common(first.nodes, second.nodes),
          Common(first.triangles, second.triangles),
          Common(first.elements, second.elements),
          Common(first.quads, second.quads),
          Common(first.sides, second.sides),
          std::move(selectors)};
}

}  // namespace fascicle
