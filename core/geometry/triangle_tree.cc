// References: Ericson 2005, "Real-Time Collision Detection"; Van Oosterom and Strackee 1983, "The Solid Angle of a
// Plane Triangle", IEEE Trans. Biomed. Eng. 30(2); Jacobson, Kavan and Sorkine-Hornung 2013, "Robust Inside-Outside
// Segmentation using Generalized Winding Numbers", ACM TOG 32(4); Barill, Dickson, Schmidt, Levin and Jacobson 2018,
// "Fast Winding Numbers for Soups and Clouds", ACM TOG 37(4).
#include "core/geometry/triangle_tree.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/check.h"
#include "core/base/stop.h"

namespace fascicle {
namespace {

constexpr std::int32_t kLeaf = 4;
// Boxes farther away than this multiple of their radius are treated as dipoles.
constexpr double kFar = 2.5;
// Splitting by count gives at most this many levels for 2^31 triangles.
constexpr std::size_t kDeepest = 64;

// [Ericson 2005, 5.1.5]
Vec3 NearestOfTriangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return a;
  const Vec3 bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
  const Vec3 cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
  const double scale = 1 / (va + vb + vc);
  return a + vb * scale * ab + vc * scale * ac;
}

// [Van Oosterom and Strackee 1983, 8]
double SolidAngle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  const double numerator = a.dot(b.cross(c));
  const double denominator = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
  return numerator == 0 && denominator == 0 ? 0 : 2 * std::atan2(numerator, denominator);
}

// Six times the signed volume of the tetrahedron; its sign tells on which side of the plane through a, b and c the
// point d is.
double SideOfPlane(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return (b - a).cross(c - a).dot(d - a);
}

bool SegmentCuts(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
  const double from = SideOfPlane(a, b, c, p), to = SideOfPlane(a, b, c, q);
  if ((from > 0) == (to > 0) || from == 0 || to == 0) return false;
  const bool s = SideOfPlane(p, q, a, b) > 0;
  return (SideOfPlane(p, q, b, c) > 0) == s && (SideOfPlane(p, q, c, a) > 0) == s;
}

// Whether an edge of `s` that has no node in common with `t` intersects `t`.
bool EdgeCuts(const std::vector<Vec3>& x, const Triangle& s, const Triangle& t) {
  const auto shared = [&](std::int32_t n) { return std::find(t.begin(), t.end(), n) != t.end(); };
  for (int k = 0; k < 3; ++k) {
    const std::int32_t p = s[k], q = s[(k + 1) % 3];
    if (!shared(p) && !shared(q) && SegmentCuts(x[p], x[q], x[t[0]], x[t[1]], x[t[2]])) return true;
  }
  return false;
}

}  // namespace

TriangleTree::TriangleTree(const TriangleMesh& surface) : surface_(surface) {
  FASCICLE_CHECK(!surface.triangles.empty(), "a tree has at least one triangle");
  const auto count = static_cast<std::int32_t>(surface.triangles.size());
  for (std::int32_t t = 0; t < count; ++t) {
    const auto& [a, b, c] = surface.triangles[t];
    centroids_.push_back((surface.nodes[a] + surface.nodes[b] + surface.nodes[c]) / 3);
    order_.push_back(t);
  }
  Build(0, count);
}

// Makes the box of order_[first, first + count) and its descendants.
std::int32_t TriangleTree::Build(std::int32_t first, std::int32_t count) {
  const auto index = static_cast<std::int32_t>(boxes_.size());
  boxes_.emplace_back();
  Box box;
  box.lowest.setConstant(std::numeric_limits<double>::infinity());
  box.highest = -box.lowest;
  box.normal.setZero();
  Vec3 weighted = Vec3::Zero(), lowest = box.lowest, highest = box.highest, middle = Vec3::Zero();
  double area = 0;
  for (std::int32_t i = first; i < first + count; ++i) {
    const auto& [a, b, c] = surface_.triangles[order_[i]];
    for (const std::int32_t n : {a, b, c}) {
      box.lowest = box.lowest.cwiseMin(surface_.nodes[n]);
      box.highest = box.highest.cwiseMax(surface_.nodes[n]);
    }
    const Vec3& centroid = centroids_[order_[i]];
    lowest = lowest.cwiseMin(centroid);
    highest = highest.cwiseMax(centroid);
    const Vec3 normal = (surface_.nodes[b] - surface_.nodes[a]).cross(surface_.nodes[c] - surface_.nodes[a]) / 2;
    box.normal += normal;
    area += normal.norm();
    weighted += normal.norm() * centroid;
    middle += centroid / count;
  }
  box.centre = area > 0 ? Vec3(weighted / area) : middle;
  box.radius = (box.highest - box.centre).cwiseAbs().cwiseMax((box.lowest - box.centre).cwiseAbs()).norm();
  if (count <= kLeaf) {
    box.first = first;
    box.count = count;
  } else {
    int axis = 0;
    (highest - lowest).maxCoeff(&axis);
    const auto less = [&](std::int32_t s, std::int32_t t) {
      return std::pair(centroids_[s][axis], s) < std::pair(centroids_[t][axis], t);
    };
    const std::int32_t half = count / 2;
    std::nth_element(order_.begin() + first, order_.begin() + first + half, order_.begin() + first + count, less);
    Build(first, half);
    Build(first + half, count - half);
  }
  box.end = static_cast<std::int32_t>(boxes_.size());
  boxes_[index] = box;
  return index;
}

double TriangleTree::SquaredDistanceTo(const Box& box, const Vec3& point) const {
  return (box.lowest - point).cwiseMax(point - box.highest).cwiseMax(0).squaredNorm();
}

TriangleTree::Nearest TriangleTree::FindNearest(const Vec3& point, double within) const {
  Nearest nearest{point, within * within, -1};
  struct Visit {
    double squared_distance;
    std::int32_t box;
  };
  std::array<Visit, kDeepest> stack;
  std::size_t depth = 0;
  stack[depth++] = {SquaredDistanceTo(boxes_[0], point), 0};
  while (depth > 0) {
    const Visit visit = stack[--depth];
    if (visit.squared_distance >= nearest.squared_distance) continue;
    const Box& box = boxes_[visit.box];
    for (std::int32_t i = box.first; i < box.first + box.count; ++i) {
      const auto& [a, b, c] = surface_.triangles[order_[i]];
      const Vec3 candidate = NearestOfTriangle(point, surface_.nodes[a], surface_.nodes[b], surface_.nodes[c]);
      const double squared = (candidate - point).squaredNorm();
      if (squared < nearest.squared_distance) nearest = {candidate, squared, order_[i]};
    }
    if (box.count > 0) continue;
    const std::int32_t left = visit.box + 1, right = boxes_[left].end;
    Visit near{SquaredDistanceTo(boxes_[left], point), left}, far{SquaredDistanceTo(boxes_[right], point), right};
    if (far.squared_distance < near.squared_distance) std::swap(near, far);
    stack[depth++] = far;
    stack[depth++] = near;
  }
  return nearest;
}

void TriangleTree::FindWithin(const Vec3& point, double reach, std::vector<std::int32_t>& triangles) const {
  const double most = reach * reach;
  const auto end = static_cast<std::int32_t>(boxes_.size());
  for (std::int32_t i = 0; i < end;) {
    const Box& box = boxes_[i];
    if (SquaredDistanceTo(box, point) > most) {
      i = box.end;
      continue;
    }
    for (std::int32_t k = box.first; k < box.first + box.count; ++k) {
      const auto& [a, b, c] = surface_.triangles[order_[k]];
      const Vec3 nearest = NearestOfTriangle(point, surface_.nodes[a], surface_.nodes[b], surface_.nodes[c]);
      if ((nearest - point).squaredNorm() <= most) triangles.push_back(order_[k]);
    }
    ++i;
  }
}

double TriangleTree::Distance(const Vec3& point) const { return std::sqrt(FindNearest(point).squared_distance); }

double TriangleTree::SignedDistance(const Vec3& point) const {
  return IsInside(point) ? -Distance(point) : Distance(point);
}

double TriangleTree::WindingNumber(const Vec3& point) const {
  double angle = 0;
  const auto end = static_cast<std::int32_t>(boxes_.size());
  for (std::int32_t i = 0; i < end;) {
    const Box& box = boxes_[i];
    const Vec3 to = box.centre - point;
    const double distance = to.norm();
    if (distance > kFar * box.radius) {
      angle += box.normal.dot(to) / (distance * distance * distance);
      i = box.end;
      continue;
    }
    for (std::int32_t k = box.first; k < box.first + box.count; ++k) {
      const auto& [a, b, c] = surface_.triangles[order_[k]];
      angle += SolidAngle(surface_.nodes[a] - point, surface_.nodes[b] - point, surface_.nodes[c] - point);
    }
    ++i;
  }
  return angle / (4 * std::numbers::pi);
}

void TriangleTree::FindCuts(std::int32_t triangle, std::vector<std::pair<std::int32_t, std::int32_t>>& pairs) const {
  const std::vector<Vec3>& x = surface_.nodes;
  const Triangle& s = surface_.triangles[triangle];
  const Vec3 lowest = x[s[0]].cwiseMin(x[s[1]]).cwiseMin(x[s[2]]);
  const Vec3 highest = x[s[0]].cwiseMax(x[s[1]]).cwiseMax(x[s[2]]);
  const auto end = static_cast<std::int32_t>(boxes_.size());
  for (std::int32_t i = 0; i < end;) {
    const Box& box = boxes_[i];
    if ((box.lowest.array() > highest.array()).any() || (box.highest.array() < lowest.array()).any()) {
      i = box.end;
      continue;
    }
    for (std::int32_t k = box.first; k < box.first + box.count; ++k) {
      const std::int32_t other = order_[k];
      if (other <= triangle) continue;
      const Triangle& t = surface_.triangles[other];
      if (EdgeCuts(x, s, t) || EdgeCuts(x, t, s)) pairs.push_back({triangle, other});
    }
    ++i;
  }
}

std::vector<std::pair<std::int32_t, std::int32_t>> TriangleTree::CuttingPairs(const std::stop_token& stop) const {
  std::vector<std::pair<std::int32_t, std::int32_t>> pairs;
  for (std::size_t t = 0; t < surface_.triangles.size(); ++t) {
    ThrowIfStopped(stop);
    FindCuts(static_cast<std::int32_t>(t), pairs);
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace fascicle
