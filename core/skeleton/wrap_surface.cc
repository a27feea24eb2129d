#include "core/skeleton/wrap_surface.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/skeleton/ellipsoid_geodesic.h"

namespace fascicle {
namespace {

using Vec2 = Eigen::Vector2d;

constexpr double kTurn = 2 * std::numbers::pi;

// The point at which the line from `p` touches the circle, going around it in the sense of `turn` (1:
// counter-clockwise).
Vec2 TangentPoint(const Vec2& p, double radius, int turn) {
  const double cosine = radius / p.norm();
  const double angle = std::atan2(p.y(), p.x()) + turn * std::acos(cosine);
  return radius * Vec2(std::cos(angle), std::sin(angle));
}

// The angle from one point to another in the sense of `turn`, 0 to 2 pi.
double AngleTo(const Vec2& from, const Vec2& to, int turn) {
  const double angle = turn * (std::atan2(to.y(), to.x()) - std::atan2(from.y(), from.x()));
  return angle - kTurn * std::floor(angle / kTurn);
}

struct Arc {
  Vec2 first, last;
  double angle = 0;   // [rad]
  double length = 0;  // of the whole line [m]
};

// The line from a to b around the circle in one sense.
Arc Around(const Vec2& a, const Vec2& b, double radius, int turn) {
  Arc arc;
  arc.first = TangentPoint(a, radius, turn);
  arc.last = TangentPoint(b, radius, -turn);
  arc.angle = AngleTo(arc.first, arc.last, turn);
  arc.length = (arc.first - a).norm() + radius * arc.angle + (b - arc.last).norm();
  return arc;
}

bool Crosses(const Vec2& a, const Vec2& b, double radius) {
  const Vec2 d = b - a;
  const double square = d.squaredNorm();
  const double t = square > 0 ? std::clamp(-a.dot(d) / square, 0.0, 1.0) : 0;
  return (a + t * d).norm() < radius;
}

// The way around a circle: the shorter one, or the one on the side of `direction`, if that is not zero.
std::optional<Arc> WayAround(const Vec2& a, const Vec2& b, double radius, const Vec2& direction) {
  if (a.norm() <= radius || b.norm() <= radius) return std::nullopt;
  const bool crosses = Crosses(a, b, radius);
  const Arc left = Around(a, b, radius, 1), right = Around(a, b, radius, -1);
  if (direction.isZero()) {
    if (!crosses) return std::nullopt;
    return left.length <= right.length ? left : right;
  }
  // Of the two ways, the one whose middle is on that side.
  const auto middle = [&](const Arc& arc, int turn) {
    const double c = std::cos(turn * arc.angle / 2), s = std::sin(turn * arc.angle / 2);
    return Vec2(c * arc.first.x() - s * arc.first.y(), s * arc.first.x() + c * arc.first.y()).dot(direction);
  };
  const bool is_left = middle(left, 1) > middle(right, -1);
  const Arc& arc = is_left ? left : right;
  const Arc& other = is_left ? right : left;
  if (crosses) return arc;
  // A straight line that does not cross the circle is free, unless it passes on the wrong side: then the way around
  // this side is the one that encloses the circle.
  const Vec2 d = b - a;
  const Vec2 nearest = a + std::clamp(-a.dot(d) / std::max(d.squaredNorm(), 1e-300), 0.0, 1.0) * d;
  if (nearest.dot(direction) >= 0 || arc.angle > std::numbers::pi || other.angle < arc.angle) return std::nullopt;
  return arc;
}

Vec3 SideOf(const WrapSurface& surface) {
  Vec3 side = Vec3::Zero();
  side[surface.side_axis] = surface.side;
  return side;
}

std::optional<Wrapping> AroundCylinder(const WrapSurface& surface, const Vec3& a, const Vec3& b) {
  const auto arc = WayAround(a.head<2>(), b.head<2>(), surface.radius, Vec2(SideOf(surface).head<2>()));
  if (!arc) return std::nullopt;
  // Unrolled, the line is straight.
  const double rise = (b.z() - a.z()) / arc->length;
  const double before = (arc->first - a.head<2>()).norm(), around = surface.radius * arc->angle;
  Wrapping wrapping;
  wrapping.first << arc->first, a.z() + rise * before;
  wrapping.last << arc->last, a.z() + rise * (before + around);
  wrapping.length = around * std::hypot(1, rise);
  const auto beyond = [&](const Vec3& x) { return std::abs(x.z()) > surface.length / 2; };
  if (beyond(wrapping.first) && beyond(wrapping.last)) return std::nullopt;
  return wrapping;
}

// The way from a to b around the sphere of a radius about the origin, in the plane of the origin and both points.
struct SphereArc {
  Vec3 first, last;
  double angle = 0;  // [rad]
};
std::optional<SphereArc> WayAroundSphere(const Vec3& a, const Vec3& b, double radius, const Vec3& side) {
  const Vec3 x = a.normalized();
  const Vec3 off = b - b.dot(x) * x;
  if (off.norm() < 1e-12 * b.norm()) return std::nullopt;
  const Vec3 y = off.normalized();
  const auto arc = WayAround(Vec2(a.norm(), 0), Vec2(b.dot(x), b.dot(y)), radius, Vec2(side.dot(x), side.dot(y)));
  if (!arc) return std::nullopt;
  return SphereArc{arc->first.x() * x + arc->first.y() * y, arc->last.x() * x + arc->last.y() * y, arc->angle};
}

std::optional<Wrapping> AroundSphere(const WrapSurface& surface, const Vec3& a, const Vec3& b) {
  const auto arc = WayAroundSphere(a, b, surface.radius, SideOf(surface));
  if (!arc) return std::nullopt;
  return Wrapping{arc->first, arc->last, surface.radius * arc->angle};
}

}  // namespace

std::optional<Wrapping> Wrap(const WrapSurface& surface, const Vec3& a, const Vec3& b) {
  switch (surface.kind) {
    case WrapSurface::Kind::kCylinder:
      return AroundCylinder(surface, a, b);
    case WrapSurface::Kind::kSphere:
      return AroundSphere(surface, a, b);
    case WrapSurface::Kind::kEllipsoid:
      break;
  }
  // An ellipsoid is a sphere in another scale. The way around that is near the shortest one.
  const Vec3 scale = surface.radii.cwiseInverse();
  const auto arc = WayAroundSphere(scale.cwiseProduct(a), scale.cwiseProduct(b), 1, SideOf(surface));
  if (!arc) return std::nullopt;
  return EllipsoidGeodesic(surface.radii, a, b, surface.radii.cwiseProduct(arc->first),
                           surface.radii.cwiseProduct(arc->last));
}

}  // namespace fascicle
