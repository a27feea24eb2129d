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

#include "core/eulerian/surface.h"

namespace fascicle {
namespace {

constexpr double kSampleSpacing = 0.5;  // between samples of a surface at rest [cells]
constexpr double kReach = 1;            // largest gap between points in contact [cells]
constexpr double kDeepest = 2;          // largest penetration that is found [cells]
constexpr double kMostOverlap = 0.5;    // of bodies at rest that are accepted [cells]
constexpr double kBonded = 0.5;         // gap at rest up to which pairs that stay together are joined [cells]
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
    all.push_back({pair.a, pair.b, false, pair.friction, pair.lasting});
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
    const ContactSurface of_a(a), of_b(b);
    double deepest = kMostOverlap * spacing;
    Vec3 place = Vec3::Zero();
    const auto find = [&](const TriangleMesh& surface, const ContactSurface& other) {
      for (const SurfaceSample& sample : SamplesOf(surface, kSampleSpacing * spacing)) {
        const Vec3 x = PlaceOfSample(surface, sample);
        if (!IsWithin(x, other.bounds(), 0)) continue;
        const std::optional<SurfaceGap> gap = other.GapAt(x, std::numeric_limits<double>::infinity());
        if (!gap || -gap->gap <= deepest) continue;
        deepest = -gap->gap;
        place = x;
      }
    };
    find(a, of_b);
    find(b, of_a);
    if (deepest == kMostOverlap * spacing) continue;
    char text[160];
    std::snprintf(text, sizeof text, "` by %.3g m at [%.4g, %.4g, %.4g] m", deepest, place[0], place[1], place[2]);
    problems.Add(IndexPath("bodies", pair.b), "overlaps with the body `" + scene.bodies[pair.a].name + text,
                 "bodies that touch may overlap by half a cell at most: move them apart, or omit the contact");
  }
}

EulerianContacts::EulerianContacts(const Scene& scene, std::vector<const EulerianBody*> bodies, ThreadTeam& team)
    : pairs_(ContactPairsOf(scene)), floors_(scene.floors), bodies_(std::move(bodies)), team_(&team) {
  for (const EulerianBody* body : bodies_) {
    samples_.push_back(SamplesOf(body->shape.surface(), kSampleSpacing * body->grid.spacing));
  }
  rest_gaps_.resize(pairs_.size());
  for (std::size_t p = 0; p < pairs_.size(); ++p) {
    for (const bool of_a : {true, false}) {
      if (pairs_[p].lasting) FindRestGaps(p, of_a);
    }
  }
}

// The larger cells of two bodies.
double EulerianContacts::CellOf(const ContactPair& pair) const {
  if (pair.floor) return bodies_[pair.a]->grid.spacing;
  return std::max(bodies_[pair.a]->grid.spacing, bodies_[pair.b]->grid.spacing);
}

void EulerianContacts::FindRestGaps(std::size_t p, bool of_a) {
  const ContactPair& pair = pairs_[p];
  const std::size_t own = of_a ? pair.a : pair.b, other = of_a ? pair.b : pair.a;
  const TriangleMesh& surface = bodies_[own]->shape.surface();
  const ContactSurface touched(bodies_[other]->shape.surface());
  for (const SurfaceSample& sample : samples_[own]) {
    const Vec3 x = PlaceOfSample(surface, sample);
    const std::optional<SurfaceGap> gap = touched.GapAt(x, kBonded * CellOf(pair));
    const bool faces = gap && AreaOfSample(surface, sample).dot(gap->normal) < 0;
    rest_gaps_[p][of_a ? 0 : 1].push_back(faces ? gap->gap : std::numeric_limits<double>::quiet_NaN());
  }
}

void EulerianContacts::Find(const EulerianWorldState& state, const std::vector<BodyStepper>& steppers) {
  const std::size_t count = bodies_.size();
  frames_.clear();
  vertices_.clear();
  bounds_.clear();
  surfaces_.clear();
  surfaces_.resize(count);
  for (std::size_t b = 0; b < count; ++b) {
    frames_.emplace_back(state.bodies[b].pose, bodies_[b]->travels);
    vertices_.push_back(SurfaceInWorld(*bodies_[b], state.bodies[b]));
    bounds_.push_back(BoundsOf(vertices_[b]));
  }
  points_.assign(pairs_.size(), {});
  depths_.assign(pairs_.size(), 0);
  for (std::size_t p = 0; p < pairs_.size(); ++p) FindPair(p, steppers);
  FindLongestStep(state, steppers);
}

const ContactSurface& EulerianContacts::SurfaceOf(std::size_t body) {
  if (!surfaces_[body]) {
    surfaces_[body] =
        std::make_unique<ContactSurface>(TriangleMesh{vertices_[body], bodies_[body]->shape.surface().triangles});
  }
  return *surfaces_[body];
}

void EulerianContacts::FindPair(std::size_t p, const std::vector<BodyStepper>& steppers) {
  const ContactPair& pair = pairs_[p];
  const double reach = (pair.lasting ? kDeepest : kReach) * CellOf(pair);
  if (DistanceOf(pair) > reach) return;
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
  const double cell = CellOf(pair), reach = (pair.lasting ? kDeepest : kReach) * cell;
  const std::vector<double>& rest_gaps = rest_gaps_[p][of_a ? 0 : 1];
  const std::size_t own = of_a ? pair.a : pair.b, other = of_a ? pair.b : pair.a;
  const ContactSurface &surface = SurfaceOf(own), &touched = SurfaceOf(other);
  const std::vector<SurfaceSample>& samples = samples_[own];
  std::vector<std::optional<Point>> found(samples.size());
  team_->For(samples.size(), 32, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      if (pair.lasting && std::isnan(rest_gaps[s])) continue;
      const Vec3 x = PlaceOfSample(surface.surface(), samples[s]);
      if (!IsWithin(x, touched.bounds(), reach)) continue;
      const std::optional<SurfaceGap> gap = touched.GapAt(x, kDeepest * cell);
      if (!gap || gap->gap > reach) continue;
      const double area = -AreaOfSample(surface.surface(), samples[s]).dot(gap->normal) / 2;
      if (!(area > 0)) continue;
      const Vec3 place = (x + gap->nearest) / 2;
      found[s] = {place, of_a ? gap->normal : Vec3(-gap->normal), gap->gap, area, {}, {}};
      if (pair.lasting) found[s]->gap -= rest_gaps[s];
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
  const TriangleMesh surface = {vertices_[pair.a], bodies_[pair.a]->shape.surface().triangles};
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
  for (const Vec3& x : vertices_[pair.a]) least = std::min(least, (x - floor.point).dot(floor.normal));
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
  if (pair.lasting) return 1;
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
    row.friction = pair.friction;
    row.lasting = pair.lasting;
    if (pair.floor) row.floor = static_cast<std::int32_t>(pair.b);
    Vec3 mean = Vec3::Zero();
    for (const auto& [k, weight] : members.points) mean += weight * points[k].normal;
    const Vec3 tangent = mean.norm() > 0 ? mean.unitOrthogonal() : Vec3::UnitX();
    const Vec3 other = mean.normalized().cross(tangent);
    for (const auto& [k, weight] : members.points) {
      const Point& point = points[k];
      Mat3 along;
      along << point.normal.transpose(), tangent.transpose(), other.transpose();
      const auto add = [&](std::size_t body, const std::vector<NodeWeight>& parts, double sign) {
        for (const NodeWeight& part : parts) {
          row.parts.push_back({body, part.node, sign * part.weight * weight * frames_[body].RowsInGrid(along)});
        }
      };
      add(pair.a, point.of_a, 1);
      if (!pair.floor) add(pair.b, point.of_b, -1);
      const double most = kMostCorrection * cell;
      const double apart = std::clamp(-point.gap, -most, most) / correction;
      row.least += weight * (point.gap > 0 && !pair.lasting ? -point.gap / dt : apart);
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
