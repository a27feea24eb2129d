#include "client/export/architecture.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <span>

#include "client/export/element_sides.h"
#include "client/lib/tetrahedra.h"
#include "core/geometry/hexahedron.h"
#include "core/geometry/solid_cells.h"

namespace fascicle::client {
namespace {

constexpr std::size_t kMostFibres = 2000;
constexpr std::size_t kNoElement = std::numeric_limits<std::size_t>::max();

using FlatTriangle = std::array<Vec3, 3>;

// Sides that belong to one hexahedron only, as triangles.
void AddOuterSides(const BodyShape& shape, const std::vector<Vec3>& x, std::vector<FlatTriangle>& surface) {
  using Polygon = std::vector<std::uint32_t>;
  std::map<Polygon, std::pair<int, Polygon>> sides;
  for (const auto& brick : shape.bricks) {
    for (Polygon& side : SidesOf(brick)) {
      Polygon key = side;
      std::sort(key.begin(), key.end());
      auto& [count, polygon] = sides[key];
      ++count;
      polygon = std::move(side);
    }
  }
  for (const auto& [key, side] : sides) {
    const auto& [count, polygon] = side;
    if (count != 1) continue;
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
      surface.push_back({x[polygon[0]], x[polygon[i]], x[polygon[i + 1]]});
    }
  }
}

// The surface of a body with its nodes at x.
std::vector<FlatTriangle> SurfaceOf(const BodyShape& shape, const std::vector<Vec3>& x) {
  std::vector<FlatTriangle> surface;
  for (const auto& t : shape.triangles) surface.push_back({x[t[0]], x[t[1]], x[t[2]]});
  for (const SurfaceTriangle& triangle : SurfaceTriangles(shape)) {
    const std::vector<FlatTriangle> parts = FlatParts(triangle, shape.quadratic(), x);
    surface.insert(surface.end(), parts.begin(), parts.end());
  }
  AddOuterSides(shape, x, surface);
  return surface;
}

// Adds the part of a triangle's cut with the plane normal . x = place to twice the area: its outline runs around the
// cross-section, with the inside on its left.
void AddCut(const FlatTriangle& triangle, const Vec3& normal, double place, Vec3& twice_area) {
  std::vector<Vec3> ends;
  for (std::size_t c = 0; c < 3; ++c) {
    const Vec3 &a = triangle[c], &b = triangle[(c + 1) % 3];
    const double from = normal.dot(a) - place, to = normal.dot(b) - place;
    if ((from < 0) == (to < 0)) continue;
    ends.push_back(a + from / (from - to) * (b - a));
  }
  if (ends.size() != 2) return;
  const Vec3 outward = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]);
  if ((ends[1] - ends[0]).dot(normal.cross(outward)) < 0) std::swap(ends[0], ends[1]);
  twice_area += ends[0].cross(ends[1]);
}

double AreaOfCut(const std::vector<FlatTriangle>& surface, const Vec3& normal, double place) {
  Vec3 twice_area = Vec3::Zero();
  for (const FlatTriangle& triangle : surface) AddCut(triangle, normal, place, twice_area);
  return 0.5 * normal.dot(twice_area);
}

// A body of hexahedra as one of tetrahedra, with the fibre and the values of their hexahedron.
BodySnapshot AsTetrahedra(const BodySnapshot& body) {
  BodySnapshot split = body;
  split.shape.bricks.clear();
  split.shape.fibres.clear();
  std::vector<std::size_t> brick_of;  // of each tetrahedron
  for (std::size_t e = 0; e < body.shape.bricks.size(); ++e) {
    std::array<std::uint32_t, 8> nodes;
    for (std::size_t c = 0; c < 8; ++c) nodes[static_cast<std::size_t>(kBrickOrder[c])] = body.shape.bricks[e][c];
    const auto solid = SolidOf(nodes).value_or(Solid<std::uint32_t>{SolidShape::kHexahedron, nodes});
    SplitSolid(solid.shape, solid.corners(), split.shape.tetrahedra);
    split.shape.fibres.resize(split.shape.tetrahedra.size(), body.shape.fibres[e]);
    brick_of.resize(split.shape.tetrahedra.size(), e);
  }
  for (BodyField& field : split.fields) {
    if (field.at_nodes) continue;
    const std::vector<double> of_hexahedra = std::move(field.values);
    const std::size_t components = field.components.size();
    field.values.clear();
    for (std::size_t t = 0; t < split.shape.tetrahedra.size(); ++t) {
      const auto first = of_hexahedra.begin() + static_cast<std::ptrdiff_t>(brick_of[t] * components);
      field.values.insert(field.values.end(), first, first + static_cast<std::ptrdiff_t>(components));
    }
  }
  return split;
}

// F a0 at a point of a tetrahedron.
Vec3 FibreIn(const BodySnapshot& body, std::size_t t, const Barycentric& point) {
  const BodyShape& shape = body.shape;
  return EdgesAt(shape, t, body.positions, point) * EdgesAt(shape, t, shape.positions, point).inverse() *
         shape.fibres[t];
}

// Traces fibres through the tetrahedra of a body at rest.
class FibreTracer {
 public:
  FibreTracer(const BodySnapshot& body, bool deformed) : shape_(body.shape) {
    const std::size_t count = shape_.tetrahedra.size();
    inverse_.reserve(count);
    stretch_.reserve(count);
    for (std::size_t t = 0; t < count; ++t) {
      inverse_.push_back(StraightEdges(t).inverse());
      stretch_.push_back(deformed ? StretchOf(body, t) : 1);
    }
    FindNeighbours();
  }

  // The length of the fibre through the middle of a tetrahedron [m].
  double LengthThrough(std::size_t tet) const {
    Vec3 middle = Vec3::Zero();
    for (const std::uint32_t node : shape_.tetrahedra[tet]) middle += shape_.positions[node] / 4;
    return LengthFrom(tet, middle, shape_.fibres[tet]) + LengthFrom(tet, middle, -shape_.fibres[tet]);
  }

 private:
  struct Exit {
    double distance = 0;
    std::size_t corner = 0;  // opposite to the side
  };

  // Paths run through the straight tetrahedra of the corners.
  Mat3 StraightEdges(std::size_t t) const {
    const std::vector<Vec3>& X = shape_.positions;
    const auto& nodes = shape_.tetrahedra[t];
    Mat3 edges;
    for (int c = 0; c < 3; ++c) edges.col(c) = X[nodes[static_cast<std::size_t>(c) + 1]] - X[nodes[0]];
    return edges;
  }

  // The mean stretch of the fibre in a tetrahedron.
  double StretchOf(const BodySnapshot& body, std::size_t t) const {
    double sum = 0;
    for (const Barycentric& point : QuadraturePoints()) sum += FibreIn(body, t, point).norm() / 4;
    return sum;
  }

  // Neighbours opposite to each corner.
  void FindNeighbours() {
    neighbours_.assign(shape_.tetrahedra.size(), {kNoElement, kNoElement, kNoElement, kNoElement});
    std::map<std::array<std::uint32_t, 3>, std::pair<std::size_t, std::size_t>> open;  // side to element and corner
    for (std::size_t t = 0; t < shape_.tetrahedra.size(); ++t) {
      for (std::size_t c = 0; c < 4; ++c) {
        std::array<std::uint32_t, 3> side;
        for (std::size_t k = 0; k < 3; ++k) side[k] = shape_.tetrahedra[t][(c + 1 + k) % 4];
        std::sort(side.begin(), side.end());
        const auto [place, is_new] = open.try_emplace(side, t, c);
        if (is_new) continue;
        neighbours_[t][c] = place->second.first;
        neighbours_[place->second.first][place->second.second] = t;
        open.erase(place);
      }
    }
  }

  // Where a ray leaves a tetrahedron.
  Exit ExitOf(std::size_t tet, const Vec3& point, const Vec3& direction) const {
    const Vec3 L = inverse_[tet] * (point - shape_.positions[shape_.tetrahedra[tet][0]]);
    const Vec3 rate = inverse_[tet] * direction;
    const double at[4] = {1 - L.sum(), L[0], L[1], L[2]}, rates[4] = {-rate.sum(), rate[0], rate[1], rate[2]};
    Exit exit{INFINITY, 0};
    for (std::size_t c = 0; c < 4; ++c) {
      if (!(rates[c] < 0)) continue;
      const double distance = std::max(at[c], 0.0) / -rates[c];
      if (distance < exit.distance) exit = {distance, c};
    }
    return exit;
  }

  double LengthFrom(std::size_t tet, Vec3 point, Vec3 direction) const {
    double length = 0;
    std::size_t before = kNoElement;
    for (std::size_t step = 0; step < shape_.tetrahedra.size() && tet != kNoElement; ++step) {
      const Vec3& fibre = shape_.fibres[tet];
      Vec3 along = fibre.dot(direction) < 0 ? Vec3(-fibre) : fibre;
      Exit exit = ExitOf(tet, point, along);
      // Where the fibres of two elements meet at their common side, the path keeps its direction.
      if (neighbours_[tet][exit.corner] == before && before != kNoElement) {
        along = direction;
        exit = ExitOf(tet, point, along);
      }
      if (!std::isfinite(exit.distance)) break;
      length += stretch_[tet] * exit.distance;
      point += exit.distance * along;
      direction = along;
      before = tet;
      tet = neighbours_[tet][exit.corner];
    }
    return length;
  }

  const BodyShape& shape_;
  std::vector<Mat3> inverse_;
  std::vector<double> stretch_;  // of the fibre in each tetrahedron
  std::vector<std::array<std::size_t, 4>> neighbours_;
};

// The volume of each element [m^3]. Frames of older servers lack the mid-edge nodes of quadratic elements, whose bent
// edges change the volume: that at rest times the field `volume_ratio`, if the frame has it, includes them.
std::vector<double> VolumesOf(const BodySnapshot& body, bool deformed) {
  const auto ratio = std::find_if(body.fields.begin(), body.fields.end(), [](const BodyField& field) {
    return field.name == "volume_ratio" && !field.at_nodes;
  });
  const bool by_ratio = deformed && !body.shape.quadratic() && ratio != body.fields.end();
  const std::vector<Vec3>& x = deformed && !by_ratio ? body.positions : body.shape.positions;
  std::vector<double> volumes;
  for (std::size_t t = 0; t < body.shape.tetrahedra.size(); ++t) {
    const double volume = VolumeOf(body.shape, t, x);
    volumes.push_back(by_ratio ? volume * ratio->values[t] : volume);
  }
  return volumes;
}

// The longest principal axis of the nodes.
Vec3 LongestAxis(const std::vector<Vec3>& x) {
  Vec3 centre = Vec3::Zero();
  for (const Vec3& point : x) centre += point / static_cast<double>(x.size());
  Mat3 covariance = Mat3::Zero();
  for (const Vec3& point : x) covariance += (point - centre) * (point - centre).transpose();
  return Eigen::SelfAdjointEigenSolver<Mat3>(covariance).eigenvectors().col(2);
}

// Tetrahedra in the middle of at most kMostFibres equal parts of the volume.
std::vector<std::size_t> Representatives(const std::vector<double>& volumes) {
  double whole = 0, sum = 0;
  for (const double volume : volumes) whole += volume;
  const std::size_t count = std::min(kMostFibres, volumes.size());
  std::vector<std::size_t> chosen;
  for (std::size_t t = 0; t < volumes.size(); ++t) {
    sum += volumes[t];
    while (chosen.size() < count && sum >= whole * (static_cast<double>(chosen.size()) + 0.5) / count) {
      chosen.push_back(t);
    }
  }
  return chosen;
}

}  // namespace

CrossSectionAreas CrossSectionAreasOf(const BodySnapshot& body, const Vec3& axis, int count, bool deformed) {
  const std::vector<Vec3>& x = deformed ? body.positions : body.shape.positions;
  const std::vector<FlatTriangle> surface = SurfaceOf(body.shape, x);
  const Vec3 normal = axis.normalized();
  double low = INFINITY, high = -INFINITY;
  for (const Vec3& point : x) {
    low = std::min(low, normal.dot(point));
    high = std::max(high, normal.dot(point));
  }
  CrossSectionAreas result;
  for (int i = 0; i < count; ++i) {
    result.places.push_back(low + (i + 0.5) / count * (high - low));
    result.areas.push_back(AreaOfCut(surface, normal, result.places.back()));
  }
  return result;
}

std::optional<FibreArchitecture> FibreArchitectureOf(const BodySnapshot& body,
                                                     const std::optional<Vec3>& line_of_action, bool deformed) {
  const BodyShape& shape = body.shape;
  if (!shape.fibres.empty() && !shape.bricks.empty()) {
    return FibreArchitectureOf(AsTetrahedra(body), line_of_action, deformed);
  }
  if (shape.fibres.empty() || shape.tetrahedra.empty()) return std::nullopt;
  const std::vector<Vec3>& x = deformed ? body.positions : shape.positions;
  const Vec3 line = line_of_action ? line_of_action->normalized() : LongestAxis(x);
  FibreArchitecture result;
  for (const double volume : VolumesOf(body, deformed)) result.volume += volume;
  const FibreTracer tracer(body, deformed);
  result.shortest = INFINITY;
  double cosine_over_length = 0;
  const std::vector<std::size_t> chosen = Representatives(VolumesOf(body, false));
  for (const std::size_t t : chosen) {
    const Vec3 fibre = deformed ? FibreIn(body, t, kCentroid) : shape.fibres[t];
    const double cosine = std::min(1.0, std::abs(line.dot(fibre.normalized())));
    const double length = tracer.LengthThrough(t);
    result.length += length;
    result.shortest = std::min(result.shortest, length);
    result.longest = std::max(result.longest, length);
    result.pennation += std::acos(cosine);
    cosine_over_length += cosine / length;
  }
  result.fibres = chosen.size();
  const auto count = static_cast<double>(chosen.size());
  result.length /= count;
  result.pennation /= count;
  result.cross_section = result.volume * cosine_over_length / count;
  return result;
}

}  // namespace fascicle::client
