#include "core/scene/probe_place.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <limits>

#include "core/geometry/hexahedron.h"
#include "core/geometry/triangle_distance.h"
#include "core/geometry/triangle_mesh.h"

namespace fascicle {
namespace {

// Tolerance for points at nodes, relative to the size of the body, and at the sides of elements, relative to them.
constexpr double kClose = 1e-9;

using Weights = std::vector<std::pair<std::int32_t, double>>;

// Shape functions of each type of element.
Weights WeightsIn(const Tetrahedron& t, const Vec3& L) {
  return {{t[0], 1 - L.sum()}, {t[1], L[0]}, {t[2], L[1]}, {t[3], L[2]}};
}
// A Brick is a Hexahedron with another order of nodes, but the same type.
Weights WeightsInHexahedron(const Hexahedron& hexahedron, const Vec3& at) {
  Weights weights;
  for (int a = 0; a < 8; ++a) weights.emplace_back(hexahedron[static_cast<std::size_t>(a)], TrilinearWeight(a, at));
  return weights;
}
Weights WeightsIn(const Brick& brick, const Vec3& at) {
  Weights weights;
  for (int c = 0; c < 8; ++c) {
    double weight = 1;
    for (int d = 0; d < 3; ++d) weight *= (c >> d & 1) != 0 ? at[d] : 1 - at[d];
    weights.emplace_back(brick[static_cast<std::size_t>(c)], weight);
  }
  return weights;
}
Weights WeightsIn(const Triangle& t, const Vec3& L) { return {{t[0], 1 - L[0] - L[1]}, {t[1], L[0]}, {t[2], L[1]}}; }

const std::vector<Tetrahedron>& ElementsOf(const TetShape& shape) { return shape.mesh.tetrahedra; }
const std::vector<Brick>& ElementsOf(const VoxelShape& shape) { return shape.mesh.bricks; }
const std::vector<Triangle>& ElementsOf(const SurfaceShape& shape) { return shape.mesh.triangles; }

// The coordinates of corner c of an element.
Vec3 CornerOf(const Brick&, std::size_t c) {
  return {static_cast<double>(c & 1), static_cast<double>(c >> 1 & 1), static_cast<double>(c >> 2)};
}
template <class Simplex>
Vec3 CornerOf(const Simplex&, std::size_t c) {
  return c == 0 ? Vec3(Vec3::Zero()) : Vec3(Vec3::Unit(static_cast<Eigen::Index>(c) - 1));
}

// The coordinates in the first hexahedron that contains the point, among those of the tetrahedra that do: where sides
// are not flat, a point beside a hexahedron may be in one of its tetrahedra. At its nearest place if there is none.
std::optional<ProbePlace> HexahedronAt(const TetMesh& mesh, const std::vector<std::int32_t>& candidates,
                                       const Vec3& point) {
  std::optional<ProbePlace> nearest;
  double least = std::numeric_limits<double>::infinity();
  for (const std::int32_t h : candidates) {
    const std::optional<Vec3> x = CoordinatesIn(NodesOfHexahedron(mesh, static_cast<std::size_t>(h)), point);
    if (!x) continue;
    const Vec3 inside = x->cwiseMax(0).cwiseMin(1);
    const double outside = (*x - inside).norm();
    if (!(outside < least)) continue;
    least = outside;
    nearest = ProbePlace{h, inside};
    if (outside <= kClose) break;
  }
  return nearest;
}

std::optional<ProbePlace> ElementAt(const TetShape& shape, const Vec3& point) {
  const std::vector<Vec3>& X = shape.mesh.nodes;
  std::vector<std::int32_t> hexahedra;
  const std::vector<std::int32_t> hexahedron_of = HexahedraOfTetrahedra(shape.mesh);
  for (std::size_t e = 0; e < shape.mesh.tetrahedra.size(); ++e) {
    const Tetrahedron& t = shape.mesh.tetrahedra[e];
    Mat3 edges;
    for (int c = 0; c < 3; ++c) edges.col(c) = X[t[c + 1]] - X[t[0]];
    const Vec3 L = edges.inverse() * (point - X[t[0]]);
    if (!(L.minCoeff() >= -kClose && L.sum() <= 1 + kClose)) continue;
    if (shape.mesh.hexahedra.empty()) return ProbePlace{static_cast<std::int32_t>(e), L};
    hexahedra.push_back(hexahedron_of[e]);
  }
  return HexahedronAt(shape.mesh, hexahedra, point);
}

std::optional<ProbePlace> ElementAt(const VoxelShape& shape, const Vec3& point) {
  const VoxelGrid& grid = shape.mesh.grid;
  for (std::size_t e = 0; e < shape.mesh.bricks.size(); ++e) {
    const Vec3 away = grid.direction.transpose() * (point - shape.mesh.nodes[shape.mesh.bricks[e][0]]);
    const Vec3 at = away.cwiseQuotient(grid.spacing);
    if (at.minCoeff() >= -kClose && at.maxCoeff() <= 1 + kClose) return ProbePlace{static_cast<std::int32_t>(e), at};
  }
  return std::nullopt;
}

// The nearest triangle.
std::optional<ProbePlace> ElementAt(const SurfaceShape& shape, const Vec3& point) {
  const std::vector<Vec3>& X = shape.mesh.nodes;
  double nearest = std::numeric_limits<double>::infinity();
  std::optional<ProbePlace> place;
  for (std::size_t e = 0; e < shape.mesh.triangles.size(); ++e) {
    const Triangle& t = shape.mesh.triangles[e];
    const double distance = SquaredDistance(point, X[t[0]], X[t[1]], X[t[2]]);
    if (!(distance < nearest)) continue;
    nearest = distance;
    const Vec3 u = X[t[1]] - X[t[0]], v = X[t[2]] - X[t[0]], away = point - X[t[0]];
    const Vec3 normal = u.cross(v);
    double a = away.cross(v).dot(normal) / normal.squaredNorm(), b = u.cross(away).dot(normal) / normal.squaredNorm();
    a = std::clamp(a, 0.0, 1.0);
    b = std::clamp(b, 0.0, 1 - a);
    place = ProbePlace{static_cast<std::int32_t>(e), Vec3(a, b, 0)};
  }
  return place;
}

// The first hexahedron of a node, preferably one that does not repeat it: a hexahedron has no inverse at a repeated
// node. If all do, beside the node.
ProbePlace HexahedronWith(const TetMesh& mesh, std::int32_t node) {
  constexpr double kBeside = 1e-6;
  std::optional<ProbePlace> collapsed;
  for (std::size_t h = 0; h < mesh.hexahedra.size(); ++h) {
    const Hexahedron& nodes = mesh.hexahedra[h];
    const auto found = std::find(nodes.begin(), nodes.end(), node);
    if (found == nodes.end()) continue;
    const Vec3 at = NodeCoordinates(static_cast<int>(found - nodes.begin()));
    if (std::count(nodes.begin(), nodes.end(), node) == 1) return {static_cast<std::int32_t>(h), at};
    if (!collapsed) collapsed = {static_cast<std::int32_t>(h), at + kBeside * (Vec3::Constant(0.5) - at)};
  }
  return collapsed.value_or(ProbePlace{});
}

std::int32_t NearestNode(const std::vector<Vec3>& nodes, const Vec3& point) {
  std::size_t nearest = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if ((nodes[i] - point).squaredNorm() < (nodes[nearest] - point).squaredNorm()) nearest = i;
  }
  return static_cast<std::int32_t>(nearest);
}

}  // namespace

LocatedProbe LocateProbe(std::string name, std::int32_t body, const Shape& shape, const Vec3& point) {
  return std::visit(
      [&](const auto& s) {
        const std::vector<Vec3>& X = s.mesh.nodes;
        LocatedProbe located = {{std::move(name), body, NearestNode(X, point), std::nullopt}};
        located.outside = (X[static_cast<std::size_t>(located.probe.node)] - point).norm();
        if (located.outside <= kClose * Diagonal(X)) return located;
        located.probe.inside = ElementAt(s, point);
        if (!located.probe.inside) return located;
        Vec3 at = Vec3::Zero();
        for (const auto& [node, weight] : WeightsAt(*located.probe.inside, shape)) at += weight * X[node];
        located.outside = (at - point).norm();
        return located;
      },
      shape);
}

ProbePlace PlaceOf(const Probe& probe, const Shape& shape) {
  if (probe.inside) return *probe.inside;
  if (const auto* tet = std::get_if<TetShape>(&shape); tet != nullptr && !tet->mesh.hexahedra.empty()) {
    return HexahedronWith(tet->mesh, probe.node);
  }
  return std::visit(
      [&](const auto& s) {
        const auto& elements = ElementsOf(s);
        for (std::size_t e = 0; e < elements.size(); ++e) {
          const auto corner = std::find(elements[e].begin(), elements[e].end(), probe.node) - elements[e].begin();
          const auto c = static_cast<std::size_t>(corner);
          if (c < elements[e].size()) return ProbePlace{static_cast<std::int32_t>(e), CornerOf(elements[e], c)};
        }
        return ProbePlace{};
      },
      shape);
}

std::vector<std::pair<std::int32_t, double>> WeightsAt(const ProbePlace& place, const Shape& shape) {
  if (const auto* tet = std::get_if<TetShape>(&shape); tet != nullptr && !tet->mesh.hexahedra.empty()) {
    return WeightsInHexahedron(tet->mesh.hexahedra[static_cast<std::size_t>(place.element)], place.coordinates);
  }
  return std::visit(
      [&](const auto& s) {
        return WeightsIn(ElementsOf(s)[static_cast<std::size_t>(place.element)], place.coordinates);
      },
      shape);
}

}  // namespace fascicle
