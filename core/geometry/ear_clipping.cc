// Reference: Meisters 1975, "Polygons have ears", The American Mathematical Monthly 82(6).
#include "core/geometry/ear_clipping.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "core/base/stop.h"

namespace fascicle {
namespace {

// A triangle is flat if twice its area is less than this part of its longest edge squared.
constexpr double kFlatEar = 1e-10;

using PlanePoint = Eigen::Vector2d;

double TwiceArea(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c) {
  const PlanePoint ab = b - a, ac = c - a;
  return ab.x() * ac.y() - ab.y() * ac.x();
}

double FlatArea(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c) {
  return kFlatEar * std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
}

class EarClipper {
 public:
  EarClipper(const std::vector<Vec3>& nodes, std::span<const std::int64_t> polygon, const std::stop_token& stop)
      : stop_(stop) {
    for (const std::int64_t n : polygon) {
      if (corners_.empty() || corners_.back() != n) corners_.push_back(static_cast<std::int32_t>(n));
    }
    while (corners_.size() > 1 && corners_.front() == corners_.back()) corners_.pop_back();
    Project(nodes);
  }

  std::vector<Triangle> Split() {
    if (corners_.size() < 3) return {};
    return IsFan() ? Fan() : Clip();
  }

 private:
  // Drops the coordinate along which the polygon is widest open, which changes no coordinate of flat ones.
  void Project(const std::vector<Vec3>& nodes) {
    Vec3 normal = Vec3::Zero();  // by Newell's formula
    const auto at = [&](std::size_t i) { return nodes[corners_[i % corners_.size()]]; };
    for (std::size_t i = 0; i < corners_.size(); ++i) normal += (at(i) - at(0)).cross(at(i + 1) - at(0));
    Eigen::Index axis = 0;
    normal.cwiseAbs().maxCoeff(&axis);
    const Eigen::Index u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      points_.emplace_back(at(i)[u], at(i)[v]);
      if (normal[axis] < 0) std::swap(points_.back().x(), points_.back().y());
    }
  }

  bool TurnsLeft(std::size_t a, std::size_t b, std::size_t c) const {
    return TwiceArea(points_[a], points_[b], points_[c]) > FlatArea(points_[a], points_[b], points_[c]);
  }

  bool IsFan() const {
    for (std::size_t i = 2; i < corners_.size(); ++i) {
      if (!TurnsLeft(0, i - 1, i)) return false;
    }
    return true;
  }

  std::vector<Triangle> Fan() const {
    std::vector<Triangle> triangles;
    for (std::size_t i = 2; i < corners_.size(); ++i) {
      triangles.push_back({corners_[0], corners_[i - 1], corners_[i]});
    }
    return triangles;
  }

  // Whether no other corner is in the triangle or on its edges. Corners at the place of one of its own do not count:
  // polygons around a hole go along a line twice.
  bool IsEar(std::size_t b) const {
    const std::size_t a = previous_[b], c = next_[b];
    if (!TurnsLeft(a, b, c)) return false;
    const PlanePoint &p = points_[a], &q = points_[b], &r = points_[c];
    const double slack = -FlatArea(p, q, r);
    for (std::size_t i = next_[c]; i != a; i = next_[i]) {
      const PlanePoint& x = points_[i];
      if (x == p || x == q || x == r) continue;
      if (TwiceArea(p, q, x) >= slack && TwiceArea(q, r, x) >= slack && TwiceArea(r, p, x) >= slack) return false;
    }
    return true;
  }

  std::vector<Triangle> Clip() {
    const std::size_t count = corners_.size();
    previous_.resize(count);
    next_.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      previous_[i] = (i + count - 1) % count;
      next_[i] = (i + 1) % count;
    }
    std::vector<Triangle> triangles;
    std::size_t at = 1, refused = 0;
    for (std::size_t left = count; left > 2;) {
      ThrowIfStopped(stop_);
      // A polygon that intersects itself may have no ear; it loses any corner then.
      const bool any = refused >= left;
      if (!any && !IsEar(at)) {
        ++refused;
        at = next_[at];
        continue;
      }
      triangles.push_back({corners_[previous_[at]], corners_[at], corners_[next_[at]]});
      next_[previous_[at]] = next_[at];
      previous_[next_[at]] = previous_[at];
      // Going on beyond the next corner keeps the triangles from becoming a fan of slivers.
      at = next_[next_[at]];
      refused = 0;
      --left;
    }
    return triangles;
  }

  const std::stop_token& stop_;
  std::vector<std::int32_t> corners_;
  std::vector<PlanePoint> points_;  // of the corners, counter-clockwise
  std::vector<std::size_t> previous_, next_;
};

}  // namespace

std::vector<Triangle> SplitPolygon(const std::vector<Vec3>& nodes, std::span<const std::int64_t> polygon,
                                   const std::stop_token& stop) {
  return EarClipper(nodes, polygon, stop).Split();
}

}  // namespace fascicle
