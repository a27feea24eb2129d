#include "core/geometry/hexahedron.h"

#include <Eigen/LU>
#include <algorithm>
#include <cstdint>
#include <span>

#include "core/base/stop.h"
#include "core/geometry/faces.h"
#include "core/geometry/solid_cells.h"

namespace fascicle {
namespace {

double Factor(int a, int d, const Vec3& x) { return IsFarNode(a, d) ? x[d] : 1 - x[d]; }

// A side in a form that compares equal to the neighbour's copy of the same side.
struct HexahedronSide {
  Quad nodes;             // ascending
  std::int64_t side = 0;  // 6 * hexahedron + local side
  bool operator<(const HexahedronSide& other) const {
    return nodes != other.nodes ? nodes < other.nodes : side < other.side;
  }
};

Quad QuadOf(const Hexahedron& hexahedron, std::size_t local_side) {
  const SolidSide& side = SidesOf(SolidShape::kHexahedron)[local_side];
  Quad quad;
  for (std::size_t c = 0; c < 4; ++c) quad[c] = hexahedron[static_cast<std::size_t>(side[c])];
  return quad;
}

// The sides that belong to one hexahedron only, ascending.
std::vector<std::int64_t> BoundarySides(const TetMesh& mesh, const std::stop_token& stop) {
  std::vector<HexahedronSide> sides;
  sides.reserve(6 * mesh.hexahedra.size());
  for (std::size_t h = 0; h < mesh.hexahedra.size(); ++h) {
    for (std::size_t s = 0; s < 6; ++s) {
      Quad nodes = QuadOf(mesh.hexahedra[h], s);
      std::sort(nodes.begin(), nodes.end());
      sides.push_back({nodes, static_cast<std::int64_t>(6 * h + s)});
    }
  }
  SortUnlessStopped(sides, stop);
  std::vector<std::int64_t> boundary;
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t end = i + 1;
    while (end < sides.size() && sides[end].nodes == sides[i].nodes) ++end;
    if (end == i + 1) boundary.push_back(sides[i].side);
    i = end;
  }
  std::sort(boundary.begin(), boundary.end());
  return boundary;
}

// The two triangles of a side among the faces of the hexahedron's own tetrahedra: those with all nodes on the side.
std::array<Triangle, 2> TrianglesOn(const TetMesh& mesh, std::size_t hexahedron, const Quad& quad) {
  std::array<Triangle, 2> triangles = {};
  std::size_t found = 0;
  for (std::size_t t = 6 * hexahedron; t < 6 * hexahedron + 6; ++t) {
    for (int side = 0; side < 4 && found < 2; ++side) {
      const Triangle triangle = OutwardTriangle(mesh.tetrahedra[t], side);
      const bool on_side = std::all_of(triangle.begin(), triangle.end(), [&](std::int32_t n) {
        return std::find(quad.begin(), quad.end(), n) != quad.end();
      });
      if (on_side) triangles[found++] = triangle;
    }
  }
  return triangles;
}

}  // namespace

double TrilinearWeight(int a, const Vec3& x) { return Factor(a, 0, x) * Factor(a, 1, x) * Factor(a, 2, x); }

Vec3 TrilinearValue(const HexahedronNodes& values, const Vec3& x) {
  Vec3 sum = Vec3::Zero();
  for (int a = 0; a < 8; ++a) sum += TrilinearWeight(a, x) * values[static_cast<std::size_t>(a)];
  return sum;
}

Mat3 TrilinearSlopes(const HexahedronNodes& values, const Vec3& x) {
  Mat3 slopes = Mat3::Zero();
  for (int a = 0; a < 8; ++a) {
    for (int d = 0; d < 3; ++d) {
      const double across = Factor(a, (d + 1) % 3, x) * Factor(a, (d + 2) % 3, x);
      slopes.col(d) += (IsFarNode(a, d) ? across : -across) * values[static_cast<std::size_t>(a)];
    }
  }
  return slopes;
}

Vec3 NodeCoordinates(int a) {
  Vec3 x;
  for (int d = 0; d < 3; ++d) x[d] = IsFarNode(a, d) ? 1 : 0;
  return x;
}

std::optional<Vec3> CoordinatesIn(const HexahedronNodes& nodes, const Vec3& point) {
  constexpr int kMaxIterations = 30;
  constexpr double kConverged = 1e-13, kFarAway = 10;
  Vec3 x = Vec3::Constant(0.5);
  for (int i = 0; i < kMaxIterations; ++i) {
    const Vec3 step = TrilinearSlopes(nodes, x).inverse() * (point - TrilinearValue(nodes, x));
    x += step;
    if (!(x.norm() < kFarAway)) return std::nullopt;
    if (step.norm() < kConverged) return x;
  }
  return std::nullopt;
}

std::array<double, 8> NodeVolumes(const HexahedronNodes& nodes) {
  // 2 x 2 x 2 Gauss points are exact: the integrand is of degree three along each axis.
  constexpr double kNear = 0.21132486540518711775;  // (1 - 1/sqrt(3)) / 2
  std::array<double, 8> volumes = {};
  for (int q = 0; q < 8; ++q) {
    Vec3 at;
    for (int d = 0; d < 3; ++d) at[d] = (q >> d & 1) != 0 ? 1 - kNear : kNear;
    const double volume = TrilinearSlopes(nodes, at).determinant() / 8;
    for (int a = 0; a < 8; ++a) volumes[static_cast<std::size_t>(a)] += volume * TrilinearWeight(a, at);
  }
  return volumes;
}

HexahedronNodes NodesOfHexahedron(const TetMesh& mesh, std::size_t hexahedron) {
  HexahedronNodes nodes;
  for (std::size_t a = 0; a < 8; ++a) nodes[a] = mesh.nodes[static_cast<std::size_t>(mesh.hexahedra[hexahedron][a])];
  return nodes;
}

HexahedralBoundary BoundaryOfHexahedra(const TetMesh& mesh, const std::stop_token& stop) {
  HexahedralBoundary boundary;
  for (const std::int64_t side : BoundarySides(mesh, stop)) {
    const auto h = static_cast<std::size_t>(side / 6);
    boundary.quads.push_back(QuadOf(mesh.hexahedra[h], static_cast<std::size_t>(side % 6)));
    boundary.triangles.push_back(TrianglesOn(mesh, h, boundary.quads.back()));
  }
  return boundary;
}

void SplitHexahedra(TetMesh& mesh) {
  mesh.tetrahedra.clear();
  mesh.tetrahedra.reserve(6 * mesh.hexahedra.size());
  for (const Hexahedron& hexahedron : mesh.hexahedra) {
    SplitSolid(SolidShape::kHexahedron, std::span<const std::int32_t>(hexahedron), mesh.tetrahedra);
  }
}

}  // namespace fascicle
