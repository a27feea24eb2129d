#include "core/skeleton/ellipsoid_geodesic.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace fascicle {
namespace {

constexpr int kSteps = 48;  // of an integration: 1e-10 of the length over half a turn
constexpr int kMostIterations = 30;
constexpr double kTolerance = 1e-12;

// The surface g(x) = |x / radii|^2 - 1 = 0.
class Ellipsoid {
 public:
  explicit Ellipsoid(const Vec3& radii) : weight_(radii.cwiseAbs2().cwiseInverse()) {}

  Vec3 Normal(const Vec3& x) const { return weight_.cwiseProduct(x).normalized(); }
  // The point of the surface in the direction of x.
  Vec3 Project(const Vec3& x) const { return x / std::sqrt(weight_.cwiseProduct(x).dot(x)); }
  // The second derivative of a geodesic with unit velocity v: along the normal, so that it stays on the surface.
  Vec3 Bend(const Vec3& x, const Vec3& v) const {
    const Vec3 gradient = weight_.cwiseProduct(x);
    return -(weight_.cwiseProduct(v).dot(v) / gradient.squaredNorm()) * gradient;
  }

 private:
  Vec3 weight_;
};

struct Ray {
  Vec3 x, v;  // place, unit direction
};

// Along the geodesic by `length`: the classical Runge-Kutta method of fourth order.
Ray Follow(const Ellipsoid& surface, Ray ray, double length) {
  const double h = length / kSteps;
  for (int k = 0; k < kSteps; ++k) {
    const Vec3 v1 = ray.v, a1 = surface.Bend(ray.x, v1);
    const Vec3 v2 = ray.v + h / 2 * a1, a2 = surface.Bend(ray.x + h / 2 * v1, v2);
    const Vec3 v3 = ray.v + h / 2 * a2, a3 = surface.Bend(ray.x + h / 2 * v2, v3);
    const Vec3 v4 = ray.v + h * a3, a4 = surface.Bend(ray.x + h * v3, v4);
    ray.x += h / 6 * (v1 + 2 * v2 + 2 * v3 + v4);
    ray.v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
  }
  return ray;
}

// The unknowns of the problem: a point near `base` by two tangential displacements, and a length.
class Touching {
 public:
  Touching(const Vec3& radii, const Vec3& a, const Vec3& b) : surface_(radii), a_(a), b_(b) {}

  // The first point from coordinates in the tangent plane at `base`.
  Vec3 First(const Vec3& base, const Vec3& unknowns) const {
    const Vec3 n = surface_.Normal(base);
    const Vec3 t = n.unitOrthogonal(), s = n.cross(t);
    return surface_.Project(base + unknowns[0] * t + unknowns[1] * s);
  }

  // The ray that starts there in the direction in which the line from a arrives.
  Ray Start(const Vec3& first) const {
    const Vec3 n = surface_.Normal(first);
    const Vec3 d = first - a_;
    return {first, (d - d.dot(n) * n).normalized()};
  }
  Ray End(const Vec3& first, double length) const { return Follow(surface_, Start(first), length); }

  // The sines of the angles by which the line misses: at its start out of the surface, and at its end out of the
  // surface and aside.
  Vec3 Misses(const Vec3& first, double length) const {
    const Ray end = End(first, length);
    const Vec3 n = surface_.Normal(end.x), onward = (b_ - end.x).normalized();
    return {surface_.Normal(first).dot((first - a_).normalized()), n.dot(onward), n.cross(end.v).dot(onward)};
  }

 private:
  Ellipsoid surface_;
  Vec3 a_, b_;
};

}  // namespace

std::optional<Wrapping> EllipsoidGeodesic(const Vec3& radii, const Vec3& a, const Vec3& b, const Vec3& first,
                                          const Vec3& last) {
  const Touching touching(radii, a, b);
  const double size = radii.maxCoeff(), step = 1e-7 * size;
  Vec3 base = first;
  double length = (last - first).norm();
  Vec3 misses = touching.Misses(base, length);
  for (int k = 0; k < kMostIterations && misses.norm() > kTolerance; ++k) {
    Mat3 jacobian;
    for (int i = 0; i < 3; ++i) {
      Vec3 forward = Vec3::Zero(), back = Vec3::Zero();
      forward[i] = step;
      back[i] = -step;
      jacobian.col(i) = (touching.Misses(touching.First(base, forward), length + forward[2]) -
                         touching.Misses(touching.First(base, back), length + back[2])) /
                        (2 * step);
    }
    const Vec3 change = -jacobian.fullPivLu().solve(misses);
    if (!change.allFinite()) return std::nullopt;
    // At most a fifth of the ellipsoid at once, and less where that does not help.
    double part = std::min(1.0, 0.2 * size / change.norm());
    for (int cut = 0;; ++cut) {
      const Vec3 next_base = touching.First(base, part * change);
      const double next_length = length + part * change[2];
      const Vec3 next = touching.Misses(next_base, next_length);
      if (next.norm() < misses.norm()) {
        base = next_base;
        length = next_length;
        misses = next;
        break;
      }
      if (cut == 20) {
        if (misses.norm() > 1e-8) return std::nullopt;
        k = kMostIterations;
        break;
      }
      part /= 2;
    }
  }
  const Ray end = touching.End(base, length);
  const bool goes_on = end.v.dot(b - end.x) > 0;
  if (misses.norm() > 1e-8 || length <= 0 || !goes_on) return std::nullopt;
  return Wrapping{base, end.x, length};
}

}  // namespace fascicle
