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
#include "core/base/component_names.h"

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

std::optional<Place> PlaceIn(const std::array<std::uint32_t, 4>& t, const std::vector<Vec3>& x, const Vec3& point) {
  if (!IsNear(point, t, x)) return std::nullopt;
  Mat3 edges;
  for (int c = 0; c < 3; ++c) edges.col(c) = x[t[static_cast<std::size_t>(c) + 1]] - x[t[0]];
  const Vec3 L = edges.inverse() * (point - x[t[0]]);
  if (!(L.minCoeff() >= -kSlack) || !(L.sum() <= 1 + kSlack)) return std::nullopt;
  return Place{0, {{t[0], 1 - L.sum()}, {t[1], L[0]}, {t[2], L[1]}, {t[3], L[2]}}};
}

// The coordinates from 0 to 1 in a brick, by Newton's method, which takes one step where the brick is a box.
std::optional<Place> PlaceIn(const std::array<std::uint32_t, 8>& brick, const std::vector<Vec3>& x, const Vec3& point) {
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

template <class Elements>
std::optional<Place> FindIn(const Elements& elements, const std::vector<Vec3>& x, const Vec3& point) {
  for (std::size_t e = 0; e < elements.size(); ++e) {
    if (std::optional<Place> place = PlaceIn(elements[e], x, point)) {
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
  std::size_t element = 0;
  std::vector<std::uint32_t> nodes;
};

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

template <class Elements>
std::vector<Part> ElementsIn(const Elements& elements, const std::vector<Vec3>& x, const Flags& inside) {
  std::vector<Part> parts;
  for (std::size_t e = 0; e < elements.size(); ++e) {
    if (AllIn(elements[e], inside))
      parts.push_back({Volume(elements[e], x), e, {elements[e].begin(), elements[e].end()}});
  }
  return parts;
}

// Sides in the region that belong to one element only.
template <class Elements>
std::vector<Part> FacesIn(const Elements& elements, const std::vector<Vec3>& x, const Flags& inside) {
  std::map<std::vector<std::uint32_t>, std::vector<Part>> sides;
  for (std::size_t e = 0; e < elements.size(); ++e) {
    for (std::vector<std::uint32_t>& side : SidesOf(elements[e])) {
      if (!AllIn(side, inside)) continue;
      std::vector<std::uint32_t> key = side;
      std::sort(key.begin(), key.end());
      sides[key].push_back({Area(side, x), e, std::move(side)});
    }
  }
  std::vector<Part> parts;
  for (auto& [key, of_side] : sides) {
    if (of_side.size() == 1) parts.push_back(std::move(of_side.front()));
  }
  return parts;
}

double ValueOver(const BodyField& field, std::size_t component, const Part& part) {
  const std::size_t n = field.components.size();
  if (!field.at_nodes) return field.values[n * part.element + component];
  double sum = 0;
  for (const std::uint32_t node : part.nodes) sum += field.values[n * node + component];
  return sum / static_cast<double>(part.nodes.size());
}

RegionStatistics StatisticsOf(const BodyField& field, std::size_t component, const std::vector<Part>& parts,
                              double size) {
  RegionStatistics result = {ColumnName(field, component), field.unit, 0, INFINITY, -INFINITY, 0};
  for (const Part& part : parts) {
    const double value = ValueOver(field, component, part);
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
      const std::optional<Place> place = body.shape.bricks.empty() ? FindIn(body.shape.tetrahedra, x, points[p])
                                                                   : FindIn(body.shape.bricks, x, points[p]);
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
  std::vector<Part> parts =
      shape.bricks.empty() ? ElementsIn(shape.tetrahedra, x, inside) : ElementsIn(shape.bricks, x, inside);
  sample.is_volume = !parts.empty();
  if (parts.empty())
    parts = shape.bricks.empty() ? FacesIn(shape.tetrahedra, x, inside) : FacesIn(shape.bricks, x, inside);
  for (std::size_t t = 0; t < shape.triangles.size(); ++t) {
    const auto& nodes = shape.triangles[t];
    if (AllIn(nodes, inside)) parts.push_back({Area(nodes, x), t, {nodes.begin(), nodes.end()}});
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
