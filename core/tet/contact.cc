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

ContactSearch::ContactSearch(const TetModel& model)
    : model_(model),
      seen_(model.contact().rigid.size() * model.contact().points.size()),
      found_(model.contact().points.size()),
      at_points_(model.contact().points.size()) {}

const std::vector<Touch>& ContactSearch::Find(const ContactDrive& drive, const NodalVector& x, ThreadTeam& team) {
  touches_.clear();
  const ContactModel& contact = model_.contact();
  for (std::size_t r = 0; r < contact.rigid.size(); ++r) {
    for (std::size_t b = 0; b < model_.bodies().size(); ++b) {
      if (!Touches(model_.scene().rigid_bodies[r], b)) continue;
      FindOnRigid(drive, x, static_cast<std::int32_t>(r), contact.point_begin[b], contact.point_begin[b + 1], team);
    }
  }
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
  touch.nodes = point.nodes;
  touch.weights = point.weights;
  touch.count = point.count;
  touch.allowed_depth = point.allowed_depth;
  touch.place = point.PositionIn(x);
  const SignedDistance at = shape.At(placement.ToBody(touch.place));
  touch.depth = -at.distance;
  touch.normal = placement.rotation * at.normal;
  touch.curvature = placement.rotation * at.curvature * placement.rotation.transpose();
  double start = 0;
  if (drive.start != nullptr) {
    const Placement& before = drive.at_start[static_cast<std::size_t>(rigid)];
    start = -shape.At(before.ToBody(point.PositionIn(*drive.start))).distance;
  }
  Respond(drive, x, point, start, touch);
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

void ContactSearch::Respond(const ContactDrive& drive, const NodalVector& x, const SurfacePoint& point, double start,
                            Touch& touch) const {
  const NodalVector& faces = drive.faces == nullptr ? x : *drive.faces;
  const double firm = drive.firmness * StiffnessFacing(point, touch.normal, faces);
  if (Hardens(model_)) {
    touch.response = HardeningResponse(firm, touch.depth, touch.allowed_depth);
  } else if (drive.start == nullptr) {
    touch.response = ResponseAt(firm, touch.depth);
  } else {
    touch.response = ResponseAt(firm, touch.depth, start);
  }
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

}  // namespace

std::vector<ContactSum> SumsOfRigidBodies(const Placements& placements, std::span<const Touch> touches) {
  std::vector<ContactSum> sums(placements.size());
  for (const Touch& touch : touches) {
    const auto r = static_cast<std::size_t>(touch.rigid);
    AddTouch(touch, -touch.response.force * touch.normal, placements[r].position, sums[r]);
  }
  return sums;
}

double WorkOfRigidBodies(std::span<const Touch> touches, const Placements& from, const Placements& to,
                         const Placements& at) {
  double work = 0;
  for (const Touch& touch : touches) {
    const auto r = static_cast<std::size_t>(touch.rigid);
    const Vec3 X = at[r].ToBody(touch.place);
    work += touch.response.force * touch.normal.dot(to[r].ToWorld(X) - from[r].ToWorld(X));
  }
  return work;
}

void AddContactBound(const TetModel& model, const NodalVector& p, NodalVector& product) {
  const ContactModel& contact = model.contact();
  const auto of_rigid = static_cast<double>(std::min<std::size_t>(2, contact.rigid.size()));
  for (const SurfacePoint& point : contact.points) {
    const Vec3 along = of_rigid * point.stiffness * point.PositionIn(p);
    for (int a = 0; a < point.count; ++a) product[point.nodes[a]] += point.weights[a] * along;
  }
}

}  // namespace fascicle
