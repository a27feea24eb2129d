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
  Quad nodes;             // ascending, after -1 if it is a triangle
  std::int64_t side = 0;  // 6 * hexahedron + local side
  bool operator<(const HexahedronSide& other) const {
    return nodes != other.nodes ? nodes < other.nodes : side < other.side;
  }
};

// Nodes that are repeated in no known way are those of a hexahedron: mesh checks report them.
Solid<std::int32_t> KnownSolid(const Hexahedron& hexahedron) {
  return SolidOf(hexahedron).value_or(Solid<std::int32_t>{SolidShape::kHexahedron, hexahedron});
}

// A side of a solid; `in_place_of_fourth` is the last node of triangles.
Quad SideOf(const Solid<std::int32_t>& solid, std::size_t local_side, const auto& in_place_of_fourth) {
  const SolidSide& side = SidesOf(solid.shape)[local_side];
  Quad quad;
  for (std::size_t c = 0; c < 3; ++c) quad[c] = solid.nodes[static_cast<std::size_t>(side[c])];
  quad[3] = side[3] >= 0 ? solid.nodes[static_cast<std::size_t>(side[3])] : in_place_of_fourth(quad);
  return quad;
}
Quad QuadOf(const Hexahedron& hexahedron, std::size_t local_side) {
  return SideOf(KnownSolid(hexahedron), local_side, [](const Quad& quad) { return quad[2]; });
}

// The sides that belong to one hexahedron only, ascending.
std::vector<std::int64_t> BoundarySides(const TetMesh& mesh, const std::stop_token& stop) {
  std::vector<HexahedronSide> sides;
  sides.reserve(6 * mesh.hexahedra.size());
  for (std::size_t h = 0; h < mesh.hexahedra.size(); ++h) {
    const Solid<std::int32_t> solid = KnownSolid(mesh.hexahedra[h]);
    for (std::size_t s = 0; s < SidesOf(solid.shape).size(); ++s) {
      Quad nodes = SideOf(solid, s, [](const Quad&) { return -1; });
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

// The triangles of a side among the faces of the hexahedron's own tetrahedra, from `first` to before `last`: those with
// all nodes on the side.
HexahedralBoundary::Triangles TrianglesOn(const TetMesh& mesh, std::size_t first, std::size_t last, const Quad& quad) {
  HexahedralBoundary::Triangles triangles;
  const std::size_t wanted = quad[2] == quad[3] ? 1 : 2;
  for (std::size_t t = first; t < last; ++t) {
    for (int side = 0; side < 4 && triangles.count < wanted; ++side) {
      const Triangle triangle = OutwardTriangle(mesh.tetrahedra[t], side);
      const bool on_side = std::all_of(triangle.begin(), triangle.end(), [&](std::int32_t n) {
        return std::find(quad.begin(), quad.end(), n) != quad.end();
      });
      if (on_side) triangles.of_side[triangles.count++] = triangle;
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
  const std::vector<std::size_t> first = FirstTetrahedra(mesh);
  for (const std::int64_t side : BoundarySides(mesh, stop)) {
    const auto h = static_cast<std::size_t>(side / 6);
    boundary.quads.push_back(QuadOf(mesh.hexahedra[h], static_cast<std::size_t>(side % 6)));
    boundary.triangles.push_back(TrianglesOn(mesh, first[h], first[h + 1], boundary.quads.back()));
  }
  return boundary;
}

void SplitHexahedra(TetMesh& mesh) {
  mesh.tetrahedra.clear();
  mesh.tetrahedra.reserve(6 * mesh.hexahedra.size());
  for (const Hexahedron& hexahedron : mesh.hexahedra) {
    const Solid<std::int32_t> solid = KnownSolid(hexahedron);
    SplitSolid(solid.shape, solid.corners(), mesh.tetrahedra);
  }
}

void TurnOver(Hexahedron& hexahedron) {
  if (KnownSolid(hexahedron).shape == SolidShape::kPyramid) {
    std::swap(hexahedron[1], hexahedron[3]);
  } else {
    std::rotate(hexahedron.begin(), hexahedron.begin() + 4, hexahedron.end());
  }
}

std::vector<std::size_t> FirstTetrahedra(const TetMesh& mesh) {
  std::vector<std::size_t> first = {0};
  first.reserve(mesh.hexahedra.size() + 1);
  for (const Hexahedron& hexahedron : mesh.hexahedra) {
    first.push_back(first.back() + static_cast<std::size_t>(TetrahedraOf(KnownSolid(hexahedron).shape)));
  }
  return first;
}

std::vector<std::int32_t> HexahedraOfTetrahedra(const TetMesh& mesh) {
  std::vector<std::int32_t> hexahedra;
  hexahedra.reserve(mesh.tetrahedra.size());
  for (std::size_t h = 0; h < mesh.hexahedra.size(); ++h) {
    const auto count = static_cast<std::size_t>(TetrahedraOf(KnownSolid(mesh.hexahedra[h]).shape));
    hexahedra.insert(hexahedra.end(), count, static_cast<std::int32_t>(h));
  }
  return hexahedra;
}

}  // namespace fascicle
