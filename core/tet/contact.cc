#include "core/tet/contact.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

namespace fascicle {
namespace {

// Least number of points that a thread takes at a time.
constexpr std::size_t kPointGrain = 512;
// How much stiffer a contact at the allowed depth is in explicit steps.
constexpr double kHardening = 4;
// Cosines of the angles beyond which a face counts for nothing, and within which it counts completely.
constexpr double kAside = 0.2, kFacing = 0.5;
// A node that is deeper in another body than this part of an edge may be beyond the reach of forces; the allowed part.
constexpr double kDeepPart = 0.3, kAllowedPart = 0.1;

bool Hardens(const TetModel& model) {
  const Stepping stepping = model.scene().tet.stepping;
  return stepping == Stepping::kExplicit || stepping == Stepping::kMixed;
}

// Stiffness k at small depths d, more at depths near the allowed one.
FloorResponse HardeningResponse(double k, double d, double allowed) {
  if (d <= 0) return {};
  const double s = kHardening * d * d / (allowed * allowed);
  return {k * d * d * (0.5 + 0.25 * s), k * d * (1 + s), k * (1 + 3 * s)};
}

}  // namespace

Placements PlacementsOf(const TetModel& model, const Controls& controls) {
  const std::vector<RigidBody>& rigid_bodies = model.scene().rigid_bodies;
  Placements placements;
  placements.reserve(rigid_bodies.size());
  for (std::size_t k = 0; k < rigid_bodies.size(); ++k) {
    const Pose pose =
        rigid_bodies[k].motion ? PoseAfter(rigid_bodies[k].pose, controls.rigid_motions[k]) : rigid_bodies[k].pose;
    placements.push_back({RotationOf(pose), pose.position});
  }
  return placements;
}

void Touch::AddNodes(const std::array<std::int32_t, 9>& of, const std::array<double, 9>& with, int number,
                     double factor) {
  for (int a = 0; a < number; ++a, ++count) {
    nodes[count] = of[a];
    weights[count] = factor * with[a];
  }
}

ContactSearch::ContactSearch(const TetModel& model) : model_(model), start_depths_(model.contact().passes.size()) {
  const ContactModel& contact = model.contact();
  seen_.resize(contact.rigid.size() * contact.points.size());
  std::size_t points = contact.points.size();
  for (const TouchingSurface& surface : contact.surfaces) points = std::max(points, surface.points.size());
  for (const ContactPass& pass : contact.passes) faces_.emplace_back(model, pass);
  found_.resize(points);
  at_points_.resize(points);
}

const std::vector<Touch>& ContactSearch::Find(const ContactDrive& drive, const NodalVector& x, ThreadTeam& team) {
  touches_.clear();
  const ContactModel& contact = model_.contact();
  for (std::size_t r = 0; r < contact.rigid.size(); ++r) {
    for (std::size_t b = 0; b < model_.bodies().size(); ++b) {
      if (!Touches(model_.scene().rigid_bodies[r], b)) continue;
      FindOnRigid(drive, x, static_cast<std::int32_t>(r), contact.point_begin[b], contact.point_begin[b + 1], team);
    }
  }
  if (contact.passes.empty()) return touches_;
  if (drive.start != nullptr && start_ != *drive.start) FindStart(*drive.start, team);
  for (std::size_t p = 0; p < contact.passes.size(); ++p) FindOnBody(drive, x, static_cast<std::int32_t>(p), team);
  return touches_;
}

// Appends what was found at the points of [begin, end).
void ContactSearch::TakeFound(std::size_t begin, std::size_t end) {
  for (std::size_t i = begin; i < end; ++i) {
    if (found_[i] != 0) touches_.push_back(at_points_[i]);
  }
}

void ContactSearch::FindOnRigid(const ContactDrive& drive, const NodalVector& x, std::int32_t rigid, std::size_t begin,
                                std::size_t end, ThreadTeam& team) {
  const ContactModel& contact = model_.contact();
  const Placement& placement = drive.now[static_cast<std::size_t>(rigid)];
  Seen* const seen = &seen_[static_cast<std::size_t>(rigid) * contact.points.size()];
  // The distance changes at most by the way of a point.
  const auto touches = [&](const Vec3& place, Seen& last) {
    if (last.distance > 0 && (place - last.place).squaredNorm() < last.distance * last.distance) return false;
    last = {place, contact.rigid[static_cast<std::size_t>(rigid)].At(place).distance};
    return last.distance < 0;
  };
  team.For(end - begin, kPointGrain, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = begin + first; i < begin + last; ++i) {
      found_[i] = touches(placement.ToBody(contact.points[i].PositionIn(x)), seen[i]);
      if (drive.start != nullptr && found_[i] == 0) {
        const Placement& before = drive.at_start[static_cast<std::size_t>(rigid)];
        found_[i] = touches(before.ToBody(contact.points[i].PositionIn(*drive.start)), seen[i]);
      }
      if (found_[i] != 0) at_points_[i] = TouchOnRigid(drive, x, rigid, static_cast<std::int32_t>(i));
    }
  });
  TakeFound(begin, end);
}

Touch ContactSearch::TouchOnRigid(const ContactDrive& drive, const NodalVector& x, std::int32_t rigid,
                                  std::int32_t index) const {
  const SurfacePoint& point = model_.contact().points[static_cast<std::size_t>(index)];
  const ObstacleDistance& shape = model_.contact().rigid[static_cast<std::size_t>(rigid)];
  const Placement& placement = drive.now[static_cast<std::size_t>(rigid)];
  Touch touch;
  touch.rigid = rigid;
  touch.AddNodes(point.nodes, point.weights, point.count, 1);
  touch.allowed_depth = point.allowed_depth;
  touch.place = point.PositionIn(x);
  const ObstacleDistance::Place at = shape.At(placement.ToBody(touch.place));
  touch.depth = -at.distance;
  touch.normal = placement.rotation * at.normal;
  touch.curvature = placement.rotation * at.curvature * placement.rotation.transpose();
  double start = 0;
  if (drive.start != nullptr) {
    const Placement& before = drive.at_start[static_cast<std::size_t>(rigid)];
    start = -shape.At(before.ToBody(point.PositionIn(*drive.start))).distance;
  }
  Respond(drive, x, point, 1, start, touch);
  return touch;
}

double ContactSearch::StiffnessFacing(const SurfacePoint& point, const Vec3& normal, const NodalVector& x) const {
  const std::span<const SurfaceSide> sides =
      std::span(model_.contact().sides).subspan(static_cast<std::size_t>(point.first_side), point.sides);
  const auto facing = [&](const SurfaceSide& side) {
    const auto& [a, b, c, d] = side.corners;
    return -(x[c] - x[a]).cross(x[d] - x[b]).normalized().dot(normal);
  };
  // One side counts by its own angle; of several, those that face it as much as the best one.
  double best = 0;
  for (const SurfaceSide& side : sides) best = std::max(best, facing(side));
  if (!(best > 0)) return sides.size() == 1 ? 0 : point.stiffness;
  if (sides.size() == 1) best = 1;
  double sum = 0;
  for (const SurfaceSide& side : sides) {
    const double t = std::clamp((facing(side) / best - kAside) / (kFacing - kAside), 0.0, 1.0);
    sum += t * t * (3 - 2 * t) * side.stiffness;
  }
  return sum;
}

void ContactSearch::Respond(const ContactDrive& drive, const NodalVector& x, const SurfacePoint& point, double factor,
                            double start, Touch& touch) const {
  const NodalVector& faces = drive.faces == nullptr ? x : *drive.faces;
  const double firm = drive.firmness * factor * StiffnessFacing(point, touch.normal, faces);
  if (Hardens(model_)) {
    touch.response = HardeningResponse(firm, touch.depth, touch.allowed_depth);
  } else if (drive.start == nullptr) {
    touch.response = ResponseAt(firm, touch.depth);
  } else {
    touch.response = ResponseAt(firm, touch.depth, start);
  }
}

// The depths of all points of passes at the start of a step; those beyond reach count as at its end.
void ContactSearch::FindStart(const NodalVector& start, ThreadTeam& team) {
  start_ = start;
  for (std::size_t p = 0; p < faces_.size(); ++p) {
    FaceSearch& search = faces_[p];
    search.Update(start, team);
    std::vector<double>& depths = start_depths_[p];
    depths.resize(model_.contact().surfaces[static_cast<std::size_t>(model_.contact().passes[p].from)].points.size());
    team.For(depths.size(), kPointGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const auto nearest = search.Find(start, i);
        depths[i] = nearest ? -nearest->distance : -search.reach();
      }
    });
  }
}

void ContactSearch::FindOnBody(const ContactDrive& drive, const NodalVector& x, std::int32_t index, ThreadTeam& team) {
  const auto p = static_cast<std::size_t>(index);
  const ContactPass& pass = model_.contact().passes[p];
  const std::vector<TouchingSurface>& surfaces = model_.contact().surfaces;
  const TouchingSurface& from = surfaces[static_cast<std::size_t>(pass.from)];
  const TouchingSurface& onto = surfaces[static_cast<std::size_t>(pass.onto)];
  FaceSearch& search = faces_[p];
  search.Update(x, team);
  team.For(from.points.size(), kPointGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto nearest = search.Find(x, i);
      const double start = drive.start == nullptr ? 0 : start_depths_[p][i];
      found_[i] = nearest && (nearest->distance < 0 || start > 0);
      if (found_[i] == 0) continue;
      const SurfacePoint& point = from.points[i];
      Touch& touch = at_points_[i] = {};
      touch.pass = index;
      touch.AddNodes(point.nodes, point.weights, point.count, 1);
      touch.AddNodes(onto.faces[static_cast<std::size_t>(nearest->face)].nodes, nearest->weights, point.count, -1);
      touch.allowed_depth = point.allowed_depth;
      touch.place = point.PositionIn(x);
      touch.depth = -nearest->distance;
      touch.normal = nearest->normal;
      touch.curvature = nearest->curvature;
      Respond(drive, x, point, pass.factor, start, touch);
    }
  });
  TakeFound(0, from.points.size());
}

std::vector<std::vector<std::int32_t>> ContactSearch::Couplings(const NodalVector& x, ThreadTeam& team) {
  constexpr double kNear = 0.5;  // of the reach
  std::vector<std::vector<std::int32_t>> couplings;
  for (std::size_t p = 0; p < faces_.size(); ++p) {
    const ContactPass& pass = model_.contact().passes[p];
    const TouchingSurface& from = model_.contact().surfaces[static_cast<std::size_t>(pass.from)];
    const TouchingSurface& onto = model_.contact().surfaces[static_cast<std::size_t>(pass.onto)];
    faces_[p].Update(x, team);
    for (std::size_t i = 0; i < from.points.size(); ++i) {
      const SurfacePoint& point = from.points[i];
      std::vector<std::int32_t> nodes;
      faces_[p].ForFacesNear(x, i, kNear * faces_[p].reach(), [&](std::int32_t face) {
        const auto& of_face = onto.faces[static_cast<std::size_t>(face)].nodes;
        nodes.insert(nodes.end(), of_face.begin(), of_face.begin() + point.count);
      });
      if (nodes.empty()) continue;
      nodes.insert(nodes.end(), point.nodes.begin(), point.nodes.begin() + point.count);
      std::sort(nodes.begin(), nodes.end());
      nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
      couplings.push_back(std::move(nodes));
    }
  }
  std::sort(couplings.begin(), couplings.end());
  couplings.erase(std::unique(couplings.begin(), couplings.end()), couplings.end());
  return couplings;
}

std::vector<Touch> TouchesOf(const TetModel& model, const TetState& state, const Controls& controls, ThreadTeam& team) {
  ContactSearch search(model);
  return search.Find({PlacementsOf(model, controls), state.contact_firmness, nullptr, nullptr, {}}, state.positions,
                     team);
}

void AddContactForce(std::span<const Touch> touches, NodalVector& force) {
  for (const Touch& touch : touches) {
    const Vec3 push = touch.response.force * touch.normal;
    for (int a = 0; a < touch.count; ++a) force[touch.nodes[a]] += touch.weights[a] * push;
  }
}

double ContactEnergy(std::span<const Touch> touches) {
  double energy = 0;
  for (const Touch& touch : touches) energy += touch.response.energy;
  return energy;
}

double HardenedStep(double excess) { return 1 / std::sqrt(1 + 3 * kHardening * excess * excess); }

double LargestExcess(std::span<const Touch> touches) {
  double excess = 0;
  for (const Touch& touch : touches) excess = std::max(excess, touch.depth / touch.allowed_depth);
  return excess;
}

namespace {

void AddTouch(const Touch& touch, const Vec3& force, const Vec3& origin, ContactSum& sum) {
  sum.depth = std::max(sum.depth, touch.depth);
  sum.excess = std::max(sum.excess, touch.depth / touch.allowed_depth);
  sum.force += force;
  sum.moment += (touch.place - origin).cross(force);
}

// How deep nodes of one surface are inside of the other one [m], at least 0.
double DeepestNode(const ContactModel& contact, const ContactPass& pass, const NodalVector& x) {
  const TouchingSurface& from = contact.surfaces[static_cast<std::size_t>(pass.from)];
  const TouchingSurface& onto = contact.surfaces[static_cast<std::size_t>(pass.onto)];
  TriangleMesh facets;
  for (const std::int32_t n : onto.nodes) facets.nodes.push_back(x[n]);
  facets.triangles = onto.facets;
  const ObstacleShape shape = std::move(facets);
  const ObstacleDistance distance(shape);
  double deepest = 0;
  for (const std::int32_t n : from.nodes) deepest = std::max(deepest, -distance.At(x[n]).distance);
  return deepest;
}

}  // namespace

std::vector<ContactSum> SumsOfRigidBodies(const Placements& placements, std::span<const Touch> touches) {
  std::vector<ContactSum> sums(placements.size());
  for (const Touch& touch : touches) {
    if (touch.rigid < 0) continue;
    const auto r = static_cast<std::size_t>(touch.rigid);
    AddTouch(touch, -touch.response.force * touch.normal, placements[r].position, sums[r]);
  }
  return sums;
}

std::vector<ContactSum> SumsOfContacts(const TetModel& model, const NodalVector& x, std::span<const Touch> touches) {
  std::vector<ContactSum> sums(model.contact().passes.size() / 2);
  for (const Touch& touch : touches) {
    if (touch.pass < 0) continue;
    // Points of the first body in even passes: their force is that of the other body on it.
    const double sign = touch.pass % 2 == 0 ? -1 : 1;
    AddTouch(touch, sign * touch.response.force * touch.normal, Vec3::Zero(),
             sums[static_cast<std::size_t>(touch.pass / 2)]);
  }
  const ContactModel& contact = model.contact();
  for (std::size_t p = 0; p < contact.passes.size(); ++p) {
    // Facets of curved faces are not exact.
    const double edge = contact.surfaces[static_cast<std::size_t>(contact.passes[p].onto)].edge;
    const double deepest = DeepestNode(contact, contact.passes[p], x);
    if (!(deepest > kDeepPart * edge)) continue;
    sums[p / 2].depth = std::max(sums[p / 2].depth, deepest);
    sums[p / 2].excess = std::max(sums[p / 2].excess, deepest / (kAllowedPart * edge));
  }
  return sums;
}

double WorkOfRigidBodies(std::span<const Touch> touches, const Placements& from, const Placements& to,
                         const Placements& at) {
  double work = 0;
  for (const Touch& touch : touches) {
    if (touch.rigid < 0) continue;
    const auto r = static_cast<std::size_t>(touch.rigid);
    const Vec3 X = at[r].ToBody(touch.place);
    work += touch.response.force * touch.normal.dot(to[r].ToWorld(X) - from[r].ToWorld(X));
  }
  return work;
}

void AddContactBound(const TetModel& model, const NodalVector& p, NodalVector& product) {
  const auto add = [&](const SurfacePoint& point, double factor) {
    const Vec3 along = factor * point.stiffness * point.PositionIn(p);
    for (int a = 0; a < point.count; ++a) product[point.nodes[a]] += point.weights[a] * along;
  };
  const ContactModel& contact = model.contact();
  const auto of_rigid = static_cast<double>(std::min<std::size_t>(2, contact.rigid.size()));
  for (const SurfacePoint& point : contact.points) add(point, of_rigid);
  // (a - b)^2 <= 2 a^2 + 2 b^2, of the body's own points and as much of those that touch it.
  for (const TouchingSurface& surface : contact.surfaces) {
    for (const SurfacePoint& point : surface.points) add(point, 2);
  }
}

}  // namespace fascicle
