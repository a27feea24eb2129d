#include "client/export/sample.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <span>
#include <stdexcept>
#include <utility>

#include "client/export/element_sides.h"
#include "client/lib/tetrahedra.h"
#include "core/base/component_names.h"
#include "core/geometry/tet_mesh.h"

namespace fascicle::client {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kSlack = 1e-9;  // of points at the sides of elements, relative to the element

// An element's nodes with their weights at a point.
struct Place {
  std::size_t element = 0;
  std::vector<std::pair<std::uint32_t, double>> weights;
};

bool IsNear(const Vec3& point, std::span<const std::uint32_t> nodes, const std::vector<Vec3>& x) {
  Vec3 low = x[nodes[0]], high = low;
  for (const std::uint32_t node : nodes) {
    low = low.cwiseMin(x[node]);
    high = high.cwiseMax(x[node]);
  }
  const double slack = kSlack * (high - low).norm();
  return ((point - low).array() >= -slack).all() && ((high - point).array() >= -slack).all();
}

// Whether a point may be in a quadratic tetrahedron, which is within the hull of its corners and of the points with
// which its edges are Bezier curves.
bool IsNearCurved(const BodyShape& shape, std::size_t t, const std::vector<Vec3>& x, const Vec3& point) {
  std::array<Vec3, 10> hull;
  for (std::size_t c = 0; c < 4; ++c) hull[c] = x[shape.tetrahedra[t][c]];
  for (std::size_t k = 0; k < 6; ++k) {
    const auto& [i, j] = kTetEdges[k];
    hull[4 + k] =
        2 * x[shape.mid_edges[t][k]] - 0.5 * (hull[static_cast<std::size_t>(i)] + hull[static_cast<std::size_t>(j)]);
  }
  constexpr std::array<std::uint32_t, 10> kAll = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9};
  return IsNear(point, kAll, {hull.begin(), hull.end()});
}

// The place of a point in a tetrahedron, by Newton's method, which takes one step where edges are straight.
std::optional<Place> PlaceInTetrahedron(const BodyShape& shape, std::size_t t, const std::vector<Vec3>& x,
                                        const Vec3& point) {
  if (!(shape.quadratic() ? IsNearCurved(shape, t, x, point) : IsNear(point, shape.tetrahedra[t], x))) {
    return std::nullopt;
  }
  constexpr int kMostSteps = 20;
  Vec3 at = Vec3::Constant(0.25);  // barycentric coordinates of corners 1 to 3
  const auto coordinates = [&at] { return Barycentric{1 - at.sum(), at[0], at[1], at[2]}; };
  for (int step = 0; step < kMostSteps; ++step) {
    Vec3 miss = point;
    for (const auto& [node, weight] : WeightsAt(shape, t, coordinates())) miss -= weight * x[node];
    const Vec3 change = EdgesAt(shape, t, x, coordinates()).inverse() * miss;
    at += change;
    if (!shape.quadratic() || change.cwiseAbs().maxCoeff() < 1e-14) break;
  }
  if (!(at.minCoeff() >= -kSlack) || !(at.sum() <= 1 + kSlack)) return std::nullopt;
  return Place{t, WeightsAt(shape, t, coordinates())};
}

// The coordinates from 0 to 1 in a brick, by Newton's method, which takes one step where the brick is a box.
std::optional<Place> PlaceInBrick(const std::array<std::uint32_t, 8>& brick, const std::vector<Vec3>& x,
                                  const Vec3& point) {
  if (!IsNear(point, brick, x)) return std::nullopt;
  constexpr int kMostSteps = 20;
  Vec3 at = Vec3::Constant(0.5);
  std::array<double, 8> weights = {};
  for (int step = 0; step < kMostSteps; ++step) {
    Vec3 miss = point;
    Mat3 gradient = Mat3::Zero();
    for (std::size_t c = 0; c < 8; ++c) {
      const std::array<double, 3> factor = {(c & 1) != 0 ? at[0] : 1 - at[0], (c >> 1 & 1) != 0 ? at[1] : 1 - at[1],
                                            (c >> 2) != 0 ? at[2] : 1 - at[2]};
      weights[c] = factor[0] * factor[1] * factor[2];
      miss -= weights[c] * x[brick[c]];
      for (int d = 0; d < 3; ++d) {
        const double sign = (c >> d & 1) != 0 ? 1 : -1;
        gradient.col(d) += sign * factor[static_cast<std::size_t>((d + 1) % 3)] *
                           factor[static_cast<std::size_t>((d + 2) % 3)] * x[brick[c]];
      }
    }
    const Vec3 change = gradient.inverse() * miss;
    if (change.cwiseAbs().maxCoeff() < 1e-14) break;
    at += change;
  }
  if (!(at.minCoeff() >= -kSlack) || !(at.maxCoeff() <= 1 + kSlack)) return std::nullopt;
  Place place;
  for (std::size_t c = 0; c < 8; ++c) place.weights.emplace_back(brick[c], weights[c]);
  return place;
}

std::optional<Place> FindPlace(const BodyShape& shape, const std::vector<Vec3>& x, const Vec3& point) {
  for (std::size_t t = 0; t < shape.tetrahedra.size(); ++t) {
    if (std::optional<Place> place = PlaceInTetrahedron(shape, t, x, point)) return place;
  }
  for (std::size_t e = 0; e < shape.bricks.size(); ++e) {
    if (std::optional<Place> place = PlaceInBrick(shape.bricks[e], x, point)) {
      place->element = e;
      return place;
    }
  }
  return std::nullopt;
}

std::string ColumnName(const BodyField& field, std::size_t component) {
  const std::string& name = field.components[component];
  return name.empty() ? field.name : field.name + "/" + name;
}

double ValueAt(const BodyField& field, std::size_t component, const Place& place) {
  const std::size_t n = field.components.size();
  if (!field.at_nodes) return field.values[n * place.element + component];
  double sum = 0;
  for (const auto& [node, weight] : place.weights) sum += weight * field.values[n * node + component];
  return sum;
}

// A part of a region: an element, or a face with the element behind it.
struct Part {
  double size = 0;  // [m^3] or [m^2]
  // Its nodes with their shares in the mean over it.
  Place mean;
};

Part PartWithMean(double size, std::size_t element, std::span<const std::uint32_t> nodes) {
  Part part = {size, {element, {}}};
  for (const std::uint32_t node : nodes) part.mean.weights.emplace_back(node, 1. / static_cast<double>(nodes.size()));
  return part;
}

double Volume(const std::array<std::uint32_t, 4>& t, const std::vector<Vec3>& x) {
  return (x[t[1]] - x[t[0]]).cross(x[t[2]] - x[t[0]]).dot(x[t[3]] - x[t[0]]) / 6;
}

// Six tetrahedra around the diagonal from corner 0 to corner 7.
double Volume(const std::array<std::uint32_t, 8>& b, const std::vector<Vec3>& x) {
  constexpr std::array<std::array<std::size_t, 2>, 6> kSides = {{{1, 3}, {3, 2}, {2, 6}, {6, 4}, {4, 5}, {5, 1}}};
  double sum = 0;
  for (const auto& [i, j] : kSides) sum += Volume(std::array<std::uint32_t, 4>{b[0], b[i], b[j], b[7]}, x);
  return sum;
}

double Area(std::span<const std::uint32_t> nodes, const std::vector<Vec3>& x) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 1; i + 1 < nodes.size(); ++i) {
    sum += 0.5 * (x[nodes[i]] - x[nodes[0]]).cross(x[nodes[i + 1]] - x[nodes[0]]);
  }
  return sum.norm();
}

using Flags = std::vector<bool>;

bool AllIn(std::span<const std::uint32_t> nodes, const Flags& inside) {
  return std::all_of(nodes.begin(), nodes.end(), [&](std::uint32_t node) { return inside[node]; });
}

// The mean of quadratic shape functions over an element with straight edges is -1/20 at corners and 1/5 at mid-edge
// nodes.
std::vector<Part> ElementsIn(const BodyShape& shape, const std::vector<Vec3>& x, const Flags& inside) {
  std::vector<Part> parts;
  for (std::size_t t = 0; t < shape.tetrahedra.size(); ++t) {
    if (!AllIn(shape.tetrahedra[t], inside)) continue;
    parts.push_back(PartWithMean(VolumeOf(shape, t, x), t, shape.tetrahedra[t]));
    if (!shape.quadratic()) continue;
    for (auto& [node, weight] : parts.back().mean.weights) weight = -0.05;
    for (const std::uint32_t node : shape.mid_edges[t]) parts.back().mean.weights.emplace_back(node, 0.2);
  }
  for (std::size_t e = 0; e < shape.bricks.size(); ++e) {
    if (AllIn(shape.bricks[e], inside)) parts.push_back(PartWithMean(Volume(shape.bricks[e], x), e, shape.bricks[e]));
  }
  return parts;
}

// Sides of tetrahedra in the region that belong to one element only. The mean of quadratic shape functions over a side
// is that at its mid-edge nodes.
void AddTriangles(const BodyShape& shape, const std::vector<Vec3>& x, const Flags& inside, std::vector<Part>& parts) {
  for (const SurfaceTriangle& triangle : SurfaceTriangles(shape)) {
    if (!AllIn(triangle.corners, inside)) continue;
    double area = 0;
    for (const auto& [a, b, c] : FlatParts(triangle, shape.quadratic(), x)) area += 0.5 * (b - a).cross(c - a).norm();
    parts.push_back(PartWithMean(area, triangle.tetrahedron, shape.quadratic() ? triangle.middles : triangle.corners));
  }
}

// Sides in the region that belong to one element only.
std::vector<Part> FacesIn(const BodyShape& shape, const std::vector<Vec3>& x, const Flags& inside) {
  std::vector<Part> parts;
  AddTriangles(shape, x, inside, parts);
  std::map<std::vector<std::uint32_t>, std::vector<Part>> sides;
  for (std::size_t e = 0; e < shape.bricks.size(); ++e) {
    for (std::vector<std::uint32_t>& side : SidesOf(shape.bricks[e])) {
      if (!AllIn(side, inside)) continue;
      const Part part = PartWithMean(Area(side, x), e, side);
      std::sort(side.begin(), side.end());
      sides[side].push_back(part);
    }
  }
  for (auto& [key, of_side] : sides) {
    if (of_side.size() == 1) parts.push_back(std::move(of_side.front()));
  }
  return parts;
}

RegionStatistics StatisticsOf(const BodyField& field, std::size_t component, const std::vector<Part>& parts,
                              double size) {
  RegionStatistics result = {ColumnName(field, component), field.unit, 0, INFINITY, -INFINITY, 0};
  for (const Part& part : parts) {
    const double value = ValueAt(field, component, part.mean);
    result.integral += part.size * value;
    result.smallest = std::min(result.smallest, value);
    result.largest = std::max(result.largest, value);
  }
  result.mean = result.integral / size;
  return result;
}

struct NamedRegion {
  const BodySnapshot* body;
  const BodyShape::Region* region;
};

NamedRegion FindRegion(const Snapshot& snapshot, const std::string& name) {
  std::vector<NamedRegion> found;
  std::string known;
  for (const BodySnapshot& body : snapshot.bodies) {
    for (const BodyShape::Region& region : body.shape.regions) {
      const std::string full = body.shape.name + "/" + region.name;
      known += (known.empty() ? "" : ", ") + full;
      if (region.name == name || full == name) found.push_back({&body, &region});
    }
  }
  if (found.size() == 1) return found.front();
  throw std::runtime_error((found.empty() ? "there is no region `" : "several bodies have a region `") + name +
                           "`; the regions are: " + (known.empty() ? "none" : known));
}

}  // namespace

Snapshot SnapshotOf(const v1::Geometry& geometry, const v1::Frame& frame) {
  CheckFits(frame, geometry);
  Snapshot snapshot = {frame.index(), frame.time(), {}};
  std::vector<BodyShape> shapes = DecodeGeometry(geometry);
  for (std::size_t b = 0; b < shapes.size(); ++b) {
    const v1::BodyFrame& of_body = frame.bodies(static_cast<int>(b));
    BodySnapshot body;
    body.positions = DecodePositions(of_body, shapes[b].positions.size());
    BodyField displacement = {"displacement", "m", ComponentNames("displacement", 3), true, {}};
    for (std::size_t n = 0; n < body.positions.size(); ++n) {
      const Vec3 u = body.positions[n] - shapes[b].positions[n];
      displacement.values.insert(displacement.values.end(), u.begin(), u.end());
    }
    body.fields.push_back(std::move(displacement));
    for (const v1::FieldValues& field : of_body.fields()) {
      body.fields.push_back({field.name(), field.unit(),
                             ComponentNames(field.name(), static_cast<std::size_t>(field.components())),
                             field.location() == v1::FieldValues::LOCATION_NODE, DecodeField(field, shapes[b])});
    }
    body.shape = std::move(shapes[b]);
    snapshot.bodies.push_back(std::move(body));
  }
  return snapshot;
}

std::vector<SampledColumn> SampleAtPoints(const Snapshot& snapshot, const std::vector<Vec3>& points, bool deformed) {
  std::vector<SampledColumn> columns;
  std::map<std::string, std::size_t> places;
  for (const BodySnapshot& body : snapshot.bodies) {
    for (const BodyField& field : body.fields) {
      for (std::size_t c = 0; c < field.components.size(); ++c) {
        const std::string name = ColumnName(field, c);
        if (!places.try_emplace(name, columns.size()).second) continue;
        columns.push_back({name, field.unit, std::vector<double>(points.size(), kNone)});
      }
    }
  }
  for (std::size_t p = 0; p < points.size(); ++p) {
    for (const BodySnapshot& body : snapshot.bodies) {
      const std::vector<Vec3>& x = deformed ? body.positions : body.shape.positions;
      const std::optional<Place> place = FindPlace(body.shape, x, points[p]);
      if (!place) continue;
      for (const BodyField& field : body.fields) {
        for (std::size_t c = 0; c < field.components.size(); ++c) {
          columns[places.at(ColumnName(field, c))].values[p] = ValueAt(field, c, *place);
        }
      }
      break;
    }
  }
  return columns;
}

std::optional<RegionSample> SampleRegion(const Snapshot& snapshot, const std::string& name, bool deformed) {
  const NamedRegion found = FindRegion(snapshot, name);
  const BodyShape& shape = found.body->shape;
  const std::vector<Vec3>& x = deformed ? found.body->positions : shape.positions;
  Flags inside(shape.positions.size(), false);
  for (const std::uint32_t node : found.region->nodes) inside[node] = true;
  RegionSample sample;
  std::vector<Part> parts = ElementsIn(shape, x, inside);
  sample.is_volume = !parts.empty();
  if (parts.empty()) parts = FacesIn(shape, x, inside);
  for (std::size_t t = 0; t < shape.triangles.size(); ++t) {
    const auto& nodes = shape.triangles[t];
    if (AllIn(nodes, inside)) parts.push_back(PartWithMean(Area(nodes, x), t, nodes));
  }
  if (parts.empty()) return std::nullopt;
  for (const Part& part : parts) sample.size += part.size;
  for (const BodyField& field : found.body->fields) {
    for (std::size_t c = 0; c < field.components.size(); ++c) {
      sample.fields.push_back(StatisticsOf(field, c, parts, sample.size));
    }
  }
  return sample;
}

}  // namespace fascicle::client
