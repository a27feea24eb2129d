#include "client/lib/tetrahedra.h"

#include <Eigen/LU>

#include <algorithm>
#include <map>

#include "core/geometry/quadratic_tetrahedron.h"

namespace fascicle::client {
namespace {

// Corners of each side, counter-clockwise seen from outside.
constexpr std::array<std::array<std::size_t, 3>, 4> kSides = {{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};

std::size_t EdgeBetween(std::size_t i, std::size_t j) {
  const std::array<int, 2> ends = {static_cast<int>(std::min(i, j)), static_cast<int>(std::max(i, j))};
  return static_cast<std::size_t>(std::find(kTetEdges.begin(), kTetEdges.end(), ends) - kTetEdges.begin());
}

std::array<Vec3, 10> TenPositions(const BodyShape& shape, std::size_t t, const std::vector<Vec3>& x) {
  std::array<Vec3, 10> positions;
  const std::array<std::uint32_t, 10> nodes = shape.TenNodes(t);
  for (std::size_t a = 0; a < 10; ++a) positions[a] = x[nodes[a]];
  return positions;
}

Mat3 EdgesOf(const std::array<Vec3, 4>& corners) {
  Mat3 edges;
  for (int c = 0; c < 3; ++c) edges.col(c) = corners[static_cast<std::size_t>(c) + 1] - corners[0];
  return edges;
}

// The place of a curved triangle's point with barycentric coordinates (1 - a - b, a, b).
Vec3 PointOn(const SurfaceTriangle& triangle, const std::vector<Vec3>& x, double a, double b) {
  const std::array<double, 3> L = {1 - a - b, a, b};
  Vec3 sum = Vec3::Zero();
  for (std::size_t c = 0; c < 3; ++c) {
    sum += L[c] * (2 * L[c] - 1) * x[triangle.corners[c]] + 4 * L[c] * L[(c + 1) % 3] * x[triangle.middles[c]];
  }
  return sum;
}

}  // namespace

std::array<Barycentric, 4> QuadraturePoints() {
  std::array<Barycentric, 4> points;
  for (std::size_t q = 0; q < 4; ++q) {
    points[q].fill(kFarCorner);
    points[q][q] = kNearCorner;
  }
  return points;
}

Mat3 EdgesAt(const BodyShape& shape, std::size_t t, const std::vector<Vec3>& x, const Barycentric& point) {
  if (shape.quadratic()) return EdgesOf(CornersAt(TenPositions(shape, t, x), point));
  const auto& nodes = shape.tetrahedra[t];
  return EdgesOf({x[nodes[0]], x[nodes[1]], x[nodes[2]], x[nodes[3]]});
}

double VolumeOf(const BodyShape& shape, std::size_t t, const std::vector<Vec3>& x) {
  if (!shape.quadratic()) return EdgesAt(shape, t, x, kCentroid).determinant() / 6;
  const std::array<Vec3, 10> positions = TenPositions(shape, t, x);
  double volume = 0;
  for (const Barycentric& point : QuadraturePoints()) {
    volume += EdgesOf(CornersAt(positions, point)).determinant() / 24;
  }
  return volume;
}

std::vector<std::pair<std::uint32_t, double>> WeightsAt(const BodyShape& shape, std::size_t t, const Barycentric& L) {
  std::vector<std::pair<std::uint32_t, double>> weights;
  const auto& corners = shape.tetrahedra[t];
  for (std::size_t c = 0; c < 4; ++c) {
    weights.emplace_back(corners[c], shape.quadratic() ? L[c] * (2 * L[c] - 1) : L[c]);
  }
  for (std::size_t k = 0; k < 6 && shape.quadratic(); ++k) {
    const auto& [i, j] = kTetEdges[k];
    weights.emplace_back(shape.mid_edges[t][k], 4 * L[static_cast<std::size_t>(i)] * L[static_cast<std::size_t>(j)]);
  }
  return weights;
}

std::vector<SurfaceTriangle> SurfaceTriangles(const BodyShape& shape) {
  std::map<std::array<std::uint32_t, 3>, std::pair<int, SurfaceTriangle>> sides;
  for (std::size_t t = 0; t < shape.tetrahedra.size(); ++t) {
    for (const auto& side : kSides) {
      SurfaceTriangle triangle = {t, {}, {}};
      for (std::size_t c = 0; c < 3; ++c) {
        triangle.corners[c] = shape.tetrahedra[t][side[c]];
        if (shape.quadratic()) triangle.middles[c] = shape.mid_edges[t][EdgeBetween(side[c], side[(c + 1) % 3])];
      }
      std::array<std::uint32_t, 3> key = triangle.corners;
      std::sort(key.begin(), key.end());
      auto& [count, first] = sides[key];
      if (count++ == 0) first = triangle;
    }
  }
  std::vector<SurfaceTriangle> surface;
  for (const auto& [key, side] : sides) {
    if (side.first == 1) surface.push_back(side.second);
  }
  return surface;
}

std::vector<std::array<Vec3, 3>> FlatParts(const SurfaceTriangle& triangle, bool quadratic,
                                           const std::vector<Vec3>& x) {
  if (!quadratic) return {{x[triangle.corners[0]], x[triangle.corners[1]], x[triangle.corners[2]]}};
  constexpr int kParts = 8;  // along each edge
  const auto at = [&](int i, int j) {
    return PointOn(triangle, x, static_cast<double>(i) / kParts, static_cast<double>(j) / kParts);
  };
  std::vector<std::array<Vec3, 3>> parts;
  for (int i = 0; i < kParts; ++i) {
    for (int j = 0; i + j < kParts; ++j) {
      parts.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
      if (i + j + 1 < kParts) parts.push_back({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return parts;
}

}  // namespace fascicle::client
