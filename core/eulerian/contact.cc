#include "core/eulerian/contact.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "core/base/vector_text.h"
#include "core/eulerian/surface.h"

namespace fascicle {
namespace {

constexpr double kSampleSpacing = 0.5;  // between samples of a surface at rest [cells]
constexpr double kReach = 1;            // largest gap between points in contact [cells]
constexpr double kDeepest = 2;          // largest penetration that is found [cells]
constexpr double kMostOverlap = 0.5;    // of bodies at rest that are accepted [cells]
constexpr double kNear = 0.1;           // predicted gap at which a point no longer counts [cells]
constexpr double kMostMove = 0.5;       // of two bodies that touch, relative to each other in a step [cells]
constexpr double kLeastArea = 0.3;      // of a row that is not joined with its neighbour [square cells]
// A penetration vanishes in this many steps, or this many steps that waves allow, whichever is longer.
constexpr double kCorrectionSteps = 5, kCorrectionWaves = 10;
constexpr double kMostCorrection = 0.25;  // of the penetration in that time [cells]

// The free and prescribed nodes that determine the velocity at a point at or near the solid.
std::vector<NodeWeight> VelocityWeights(const EulerianGrid& grid, const NodeRoles& roles, const Vec3& point) {
  const EulerianGrid::Place place = grid.PlaceOf(point);
  std::vector<NodeWeight> parts;
  const auto [i, j, k] = place.cell;
  for (int c = 0; c < 8; ++c) {
    const double weight = CornerWeight(c, place.within);
    if (weight == 0) continue;
    const GridIndex at = {i + (c & 1), j + (c >> 1 & 1), k + (c >> 2)};
    const std::size_t node = grid.NodeNumber(at);
    if (roles.HasVelocity(node)) {
      roles.ForRoots(node, [&](std::size_t root, double part) { parts.push_back({root, weight * part}); });
    } else {
      for (const NodeWeight& root : ExtrapolationWeights(grid, at, roles.inside)) {
        parts.push_back({root.node, weight * root.weight});
      }
    }
  }
  MergeByNode(parts, [](NodeWeight& sum, const NodeWeight& part) { sum.weight += part.weight; });
  double total = 0;
  for (const NodeWeight& part : parts) total += part.weight;
  for (NodeWeight& part : parts) part.weight /= total;
  return parts;
}

Vec3 PlaceOfSample(const TriangleMesh& surface, const SurfaceSample& sample) {
  const Triangle& t = surface.triangles[sample.triangle];
  return sample.weights[0] * surface.nodes[t[0]] + sample.weights[1] * surface.nodes[t[1]] +
         sample.weights[2] * surface.nodes[t[2]];
}

// Outwards, of the length of the sample's area [m^2].
Vec3 AreaOfSample(const TriangleMesh& surface, const SurfaceSample& sample) {
  const auto& [a, b, c] = surface.triangles[sample.triangle];
  return sample.part / 2 * (surface.nodes[b] - surface.nodes[a]).cross(surface.nodes[c] - surface.nodes[a]);
}

double DistanceBetween(const Bounds& a, const Bounds& b) {
  return (a.lowest - b.highest).cwiseMax(b.lowest - a.highest).cwiseMax(0).norm();
}

bool IsWithin(const Vec3& x, const Bounds& bounds, double reach) {
  return ((x - bounds.lowest).array() >= -reach).all() && ((bounds.highest - x).array() >= -reach).all();
}

// The largest difference of two rigid velocities in a box: at one of its corners, since the difference is linear.
double LargestDifference(const RigidVelocity& u, const RigidVelocity& v, const Bounds& box) {
  double largest = 0;
  for (int c = 0; c < 8; ++c) {
    Vec3 corner = box.lowest;
    for (int d = 0; d < 3; ++d) {
      if ((c >> d & 1) != 0) corner[d] = box.highest[d];
    }
    largest = std::max(largest, (u.At(corner) - v.At(corner)).norm());
  }
  return largest;
}

// Points in cells of the collision grid. Cells with little area join their neighbour with the largest one, because rows
// that act on the same nodes could not be told apart.
struct CellPoints {
  double area = 0;
  std::vector<std::pair<std::size_t, double>> points;  // and their weights
};
using CollisionCells = std::map<std::array<std::int64_t, 3>, CellPoints>;

CollisionCells Joined(const CollisionCells& cells, double least) {
  CollisionCells joined;
  for (const auto& [at, cell] : cells) {
    std::array<std::int64_t, 3> target = at;
    double largest = least;
    for (int n = 0; n < 27 && cell.area < least; ++n) {
      const std::array<std::int64_t, 3> beside = {at[0] - 1 + n % 3, at[1] - 1 + n / 3 % 3, at[2] - 1 + n / 9};
      const auto found = cells.find(beside);
      if (found == cells.end() || found->second.area <= largest) continue;
      largest = found->second.area;
      target = beside;
    }
    CellPoints& sum = joined[target];
    sum.area += cell.area;
    sum.points.insert(sum.points.end(), cell.points.begin(), cell.points.end());
  }
  return joined;
}

}  // namespace

std::vector<ContactPair> ContactPairsOf(const Scene& scene) {
  std::vector<ContactPair> all;
  for (const TouchingPair& pair : PairsOf(scene.contacts, scene.bodies.size())) {
    all.push_back({pair.a, pair.b});
  }
  for (std::size_t a = 0; a < scene.bodies.size(); ++a) {
    for (std::size_t floor = 0; floor < scene.floors.size(); ++floor) all.push_back({a, floor, true});
  }
  return all;
}

void CheckOverlaps(const Scene& scene, Problems& problems) {
  const double spacing = scene.eulerian.cell_size;
  for (const ContactPair& pair : ContactPairsOf(scene)) {
    if (pair.floor) continue;
    const TriangleMesh &a = scene.bodies[pair.a].surface().mesh, &b = scene.bodies[pair.b].surface().mesh;
    if (a.triangles.empty() || b.triangles.empty()) continue;
    if (DistanceBetween(BoundsOf(a.nodes), BoundsOf(b.nodes)) > 0) continue;
    const SurfaceDistance of_a(a), of_b(b);
    double deepest = kMostOverlap * spacing;
    Vec3 place = Vec3::Zero();
    const auto find = [&](const TriangleMesh& surface, const TriangleMesh& other, const SurfaceDistance& distance) {
      const Bounds bounds = BoundsOf(other.nodes);
      for (const SurfaceSample& sample : SamplesOf(surface, kSampleSpacing * spacing)) {
        const Vec3 x = PlaceOfSample(surface, sample);
        if (!IsWithin(x, bounds, 0)) continue;
        const double depth = -distance.At(x)->distance;
        if (depth <= deepest) continue;
        deepest = depth;
        place = x;
      }
    };
    find(a, b, of_b);
    find(b, a, of_a);
    if (deepest == kMostOverlap * spacing) continue;
    char depth[32];
    std::snprintf(depth, sizeof depth, "%.3g m", deepest);
    problems.Add(
        IndexPath("bodies", pair.b),
        "overlaps with the body `" + scene.bodies[pair.a].name + "` by " + depth + " at " + VectorText(place) + " m",
        "bodies that touch may overlap by half a cell at most: move them apart, or omit the contact");
  }
}

EulerianContacts::EulerianContacts(const Scene& scene, std::vector<const EulerianBody*> bodies, ThreadTeam& team)
    : pairs_(ContactPairsOf(scene)), floors_(scene.floors), bodies_(std::move(bodies)), team_(&team) {
  for (const EulerianBody* body : bodies_) {
    samples_.push_back(SamplesOf(body->shape.surface(), kSampleSpacing * body->grid.spacing));
  }
}

// The larger cells of two bodies.
double EulerianContacts::CellOf(const ContactPair& pair) const {
  if (pair.floor) return bodies_[pair.a]->grid.spacing;
  return std::max(bodies_[pair.a]->grid.spacing, bodies_[pair.b]->grid.spacing);
}

void EulerianContacts::Find(const EulerianWorldState& state, const std::vector<BodyStepper>& steppers) {
  const std::size_t count = bodies_.size();
  frames_.clear();
  surfaces_.clear();
  bounds_.clear();
  distances_.clear();
  distances_.resize(count);
  for (std::size_t b = 0; b < count; ++b) {
    frames_.emplace_back(state.bodies[b].pose, bodies_[b]->travels);
    surfaces_.push_back({SurfaceInWorld(*bodies_[b], state.bodies[b]), bodies_[b]->shape.surface().triangles});
    bounds_.push_back(BoundsOf(surfaces_[b].nodes));
  }
  points_.assign(pairs_.size(), {});
  depths_.assign(pairs_.size(), 0);
  for (std::size_t p = 0; p < pairs_.size(); ++p) FindPair(p, steppers);
  FindLongestStep(state, steppers);
}

const SurfaceDistance& EulerianContacts::DistanceFrom(std::size_t body) {
  if (!distances_[body]) distances_[body] = std::make_unique<SurfaceDistance>(surfaces_[body]);
  return *distances_[body];
}

void EulerianContacts::FindPair(std::size_t p, const std::vector<BodyStepper>& steppers) {
  const ContactPair& pair = pairs_[p];
  if (DistanceOf(pair) > kReach * CellOf(pair)) return;
  if (pair.floor) {
    FindOnFloor(p, steppers, points_[p]);
  } else {
    FindSide(p, true, steppers, points_[p]);
    FindSide(p, false, steppers, points_[p]);
  }
  for (const Point& point : points_[p]) depths_[p] = std::max(depths_[p], -point.gap);
}

// The points of the samples of one body of the pair.
void EulerianContacts::FindSide(std::size_t p, bool of_a, const std::vector<BodyStepper>& steppers, Points& points) {
  const ContactPair& pair = pairs_[p];
  const double cell = CellOf(pair), reach = kReach * cell;
  const std::size_t own = of_a ? pair.a : pair.b, other = of_a ? pair.b : pair.a;
  const TriangleMesh& surface = surfaces_[own];
  const SurfaceDistance& touched = DistanceFrom(other);
  const std::vector<SurfaceSample>& samples = samples_[own];
  std::vector<std::optional<Point>> found(samples.size());
  team_->For(samples.size(), 32, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      const Vec3 x = PlaceOfSample(surface, samples[s]);
      if (!IsWithin(x, bounds_[other], reach)) continue;
      const std::optional<SurfaceDistance::Place> at = touched.At(x, kDeepest * cell);
      if (!at || at->distance > reach) continue;
      const double area = -AreaOfSample(surface, samples[s]).dot(at->normal) / 2;
      if (!(area > 0)) continue;
      const Vec3 place = (x + at->nearest) / 2;
      found[s] = {place, of_a ? at->normal : Vec3(-at->normal), at->distance, area, {}, {}};
      found[s]->of_a =
          VelocityWeights(bodies_[pair.a]->grid, steppers[pair.a].roles(), frames_[pair.a].PointInGrid(place));
      found[s]->of_b =
          VelocityWeights(bodies_[pair.b]->grid, steppers[pair.b].roles(), frames_[pair.b].PointInGrid(place));
    }
  });
  for (std::optional<Point>& point : found) {
    if (point && !point->of_a.empty() && !point->of_b.empty()) points.push_back(std::move(*point));
  }
}

void EulerianContacts::FindOnFloor(std::size_t p, const std::vector<BodyStepper>& steppers, Points& points) const {
  const ContactPair& pair = pairs_[p];
  const Floor& floor = floors_[pair.b];
  const TriangleMesh& surface = surfaces_[pair.a];
  const std::vector<SurfaceSample>& samples = samples_[pair.a];
  std::vector<std::optional<Point>> found(samples.size());
  team_->For(samples.size(), 32, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      const Vec3 x = PlaceOfSample(surface, samples[s]);
      const double gap = (x - floor.point).dot(floor.normal),
                   area = -AreaOfSample(surface, samples[s]).dot(floor.normal);
      if (gap > kReach * CellOf(pair) || !(area > 0)) continue;
      found[s] = {x, floor.normal, gap, area, {}, {}};
      found[s]->of_a = VelocityWeights(bodies_[pair.a]->grid, steppers[pair.a].roles(), frames_[pair.a].PointInGrid(x));
    }
  });
  for (std::optional<Point>& point : found) {
    if (point && !point->of_a.empty()) points.push_back(std::move(*point));
  }
}

// At most the distance between the two of a pair.
double EulerianContacts::DistanceOf(const ContactPair& pair) const {
  if (!pair.floor) return DistanceBetween(bounds_[pair.a], bounds_[pair.b]);
  const Floor& floor = floors_[pair.b];
  double least = std::numeric_limits<double>::infinity();
  for (const Vec3& x : surfaces_[pair.a].nodes) least = std::min(least, (x - floor.point).dot(floor.normal));
  return std::max(least, 0.0);
}

void EulerianContacts::FindLongestStep(const EulerianWorldState& state, const std::vector<BodyStepper>& steppers) {
  std::vector<RigidVelocity> rigid;
  std::vector<double> beside;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const RigidVelocity in_grid = RigidPartOf(bodies_[b]->grid, steppers[b].forces(), state.bodies[b].v, *team_);
    beside.push_back(steppers[b].FastestBeside(state.bodies[b].v, in_grid));
    rigid.push_back({frames_[b].PointInWorld(in_grid.centre), frames_[b].VectorInWorld(in_grid.linear),
                     frames_[b].VectorInWorld(in_grid.spin)});
  }
  longest_step_ = std::numeric_limits<double>::infinity();
  for (const ContactPair& pair : pairs_) {
    const std::size_t a = pair.a, b = pair.b;
    double speed = 0, cell = bodies_[a]->grid.spacing;
    if (pair.floor) {
      speed = LargestDifference(rigid[a], {}, bounds_[a]) + beside[a];
    } else {
      speed = std::max(LargestDifference(rigid[a], rigid[b], bounds_[a]),
                       LargestDifference(rigid[a], rigid[b], bounds_[b])) +
              beside[a] + beside[b];
      cell = std::min(cell, bodies_[b]->grid.spacing);
    }
    if (speed > 0) longest_step_ = std::min(longest_step_, std::max(DistanceOf(pair), kMostMove * cell) / speed);
  }
}

// 1 for points that would penetrate in the step, and less for those that would come near.
double EulerianContacts::WeightOf(const Point& point, const ContactPair& pair, double dt,
                                  std::span<const std::vector<Vec3>* const> velocities) const {
  const auto velocity = [&](std::size_t body, const std::vector<NodeWeight>& parts) {
    Vec3 sum = Vec3::Zero();
    for (const NodeWeight& part : parts) sum += part.weight * (*velocities[body])[part.node];
    return frames_[body].VectorInWorld(sum);
  };
  Vec3 relative = velocity(pair.a, point.of_a);
  if (!pair.floor) relative -= velocity(pair.b, point.of_b);
  const double cell = CellOf(pair);
  return std::clamp(1 - (point.gap + dt * point.normal.dot(relative)) / (kNear * cell), 0.0, 1.0);
}

std::vector<ContactRow> EulerianContacts::Rows(double dt, std::span<const std::vector<Vec3>* const> velocities,
                                               std::span<const double> waves) const {
  std::vector<ContactRow> rows;
  for (std::size_t p = 0; p < pairs_.size(); ++p) {
    if (points_[p].empty()) continue;
    double longest = waves[pairs_[p].a];
    if (!pairs_[p].floor) longest = std::max(longest, waves[pairs_[p].b]);
    const double correction = std::max(kCorrectionSteps * dt, kCorrectionWaves * longest);
    AddRows(p, dt, correction, velocities, rows);
  }
  return rows;
}

void EulerianContacts::AddRows(std::size_t p, double dt, double correction,
                               std::span<const std::vector<Vec3>* const> velocities,
                               std::vector<ContactRow>& rows) const {
  const ContactPair& pair = pairs_[p];
  const Points& points = points_[p];
  const double cell = CellOf(pair);
  CollisionCells cells;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const double weight = points[k].area * WeightOf(points[k], pair, dt, velocities);
    if (weight == 0) continue;
    std::array<std::int64_t, 3> at;
    for (int d = 0; d < 3; ++d) at[d] = static_cast<std::int64_t>(std::floor(points[k].place[d] / cell));
    cells[at].area += weight;
    cells[at].points.emplace_back(k, weight);
  }
  for (const auto& [at, members] : Joined(cells, kLeastArea * cell * cell)) {
    ContactRow& row = rows.emplace_back();
    row.area = members.area;
    if (pair.floor) row.floor = static_cast<std::int32_t>(pair.b);
    for (const auto& [k, weight] : members.points) {
      const Point& point = points[k];
      const auto add = [&, weight = weight](std::size_t body, const std::vector<NodeWeight>& parts, double sign) {
        for (const NodeWeight& part : parts) {
          row.parts.push_back(
              {body, part.node, sign * part.weight * weight * frames_[body].VectorInGrid(point.normal)});
        }
      };
      add(pair.a, point.of_a, 1);
      if (!pair.floor) add(pair.b, point.of_b, -1);
      const double most = kMostCorrection * cell;
      const double apart = std::clamp(-point.gap, -most, most) / correction;
      row.least += weight * (point.gap > 0 ? -point.gap / dt : apart);
    }
    std::stable_sort(row.parts.begin(), row.parts.end(), [](const ContactPart& a, const ContactPart& b) {
      return std::pair(a.body, a.node) < std::pair(b.body, b.node);
    });
    std::size_t count = 0;
    for (const ContactPart& part : row.parts) {
      if (count > 0 && row.parts[count - 1].body == part.body && row.parts[count - 1].node == part.node) {
        row.parts[count - 1].weight += part.weight;
      } else {
        row.parts[count++] = part;
      }
    }
    row.parts.resize(count);
  }
}

}  // namespace fascicle
