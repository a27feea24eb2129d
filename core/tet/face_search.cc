#include "core/tet/face_search.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "core/tet/face_shapes.h"

namespace fascicle {
namespace {

constexpr std::size_t kSearchGrain = 128;
// Parts of the mean edge of a face: how deep a point may be to be found, and how far nodes may move before candidates
// are found again.
constexpr double kReach = 1, kMargin = 0.25;
// Iterations of a projection on a curved face, and where they end.
constexpr int kMostIterations = 20;
constexpr double kEnough = 1e-13;
// Places of neighbouring faces that differ by less than this part of an edge are the same.
constexpr double kSamePlace = 1e-7;

// A straight line in the (u, v) plane.
struct ParameterLine {
  double u0, v0, du, dv;
};
std::span<const ParameterLine> EdgesOf(bool square) {
  static constexpr ParameterLine kSquare[] = {{0, 0, 1, 0}, {1, 0, 0, 1}, {1, 1, -1, 0}, {0, 1, 0, -1}};
  static constexpr ParameterLine kTriangle[] = {{0, 0, 1, 0}, {1, 0, -1, 1}, {0, 1, 0, -1}};
  return square ? std::span<const ParameterLine>(kSquare) : std::span<const ParameterLine>(kTriangle);
}
bool IsWithin(double u, double v, bool square) { return u >= 0 && v >= 0 && (square ? u <= 1 && v <= 1 : u + v <= 1); }

// Position and tangents of a face at a place.
struct FacePosition {
  Vec3 x = Vec3::Zero(), t1 = Vec3::Zero(), t2 = Vec3::Zero();
};
FacePosition PositionOn(ElementOrder order, const PressureFace& face, const NodalVector& x, double u, double v) {
  return WithFaceShape(order, u, v, [&](const auto& shape) {
    FacePosition at;
    for (std::size_t a = 0; a < shape.N.size(); ++a) {
      const Vec3& node = x[face.nodes[a]];
      at.x += shape.N[a] * node;
      at.t1 += shape.d1[a] * node;
      at.t2 += shape.d2[a] * node;
    }
    return at;
  });
}

}  // namespace

FaceSearch::FaceSearch(const TetModel& model, const ContactPass& pass)
    : model_(model),
      from_(model.contact().surfaces[static_cast<std::size_t>(pass.from)]),
      onto_(model.contact().surfaces[static_cast<std::size_t>(pass.onto)]),
      reach_(kReach * onto_.edge),
      margin_(kMargin * onto_.edge),
      begin_(from_.points.size() + 1, 0) {}

bool FaceSearch::HasMoved(const NodalVector& x) const {
  if (reference_.empty()) return true;
  const double most = margin_ * margin_ / 4;
  const auto moved = [&](std::int32_t n) { return !((x[n] - reference_[n]).squaredNorm() < most); };
  return std::any_of(from_.nodes.begin(), from_.nodes.end(), moved) ||
         std::any_of(onto_.nodes.begin(), onto_.nodes.end(), moved);
}

void FaceSearch::Update(const NodalVector& x, ThreadTeam& team) {
  if (!HasMoved(x)) return;
  reference_ = x;
  TriangleMesh facets;
  for (const std::int32_t n : onto_.nodes) facets.nodes.push_back(x[n]);
  facets.triangles = onto_.facets;
  const TriangleTree tree(facets);
  std::vector<std::vector<std::int32_t>> faces(from_.points.size());
  // A curved face is near its facets.
  const double reach = 1.25 * (reach_ + margin_);
  team.For(from_.points.size(), kSearchGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      tree.FindWithin(from_.points[i].PositionIn(x), reach, faces[i]);
      for (std::int32_t& facet : faces[i]) facet /= onto_.facets_per_face;
      std::sort(faces[i].begin(), faces[i].end());
      faces[i].erase(std::unique(faces[i].begin(), faces[i].end()), faces[i].end());
    }
  });
  candidates_.clear();
  for (std::size_t i = 0; i < faces.size(); ++i) {
    candidates_.insert(candidates_.end(), faces[i].begin(), faces[i].end());
    begin_[i + 1] = static_cast<std::int32_t>(candidates_.size());
  }
}

FaceSearch::Place FaceSearch::PlaceOn(const NodalVector& x, std::int32_t index, const Vec3& at) const {
  const ElementOrder order = model_.order();
  const PressureFace& face = onto_.faces[static_cast<std::size_t>(index)];
  const bool square = IsHexahedral(order);
  double u = square ? 0.5 : 1. / 3, v = u;
  // Gauss-Newton: exact for flat faces in one iteration, and fast for curved ones, because points are near.
  for (int k = 0; k < kMostIterations; ++k) {
    const FacePosition p = PositionOn(order, face, x, u, v);
    Eigen::Matrix2d A;
    A << p.t1.dot(p.t1), p.t1.dot(p.t2), p.t1.dot(p.t2), p.t2.dot(p.t2);
    const Eigen::Vector2d step = A.inverse() * Eigen::Vector2d(p.t1.dot(at - p.x), p.t2.dot(at - p.x));
    if (!step.allFinite()) break;
    u += step[0];
    v += step[1];
    if (order == ElementOrder::kLinear || step.squaredNorm() < kEnough * kEnough || !(std::abs(u) + std::abs(v) < 10)) {
      break;
    }
  }
  Place best;
  best.squared = std::numeric_limits<double>::infinity();
  double best_u = u, best_v = v;
  if (IsWithin(u, v, square)) {
    best.is_inside = true;
    best.squared = (PositionOn(order, face, x, u, v).x - at).squaredNorm();
  } else {
    for (const ParameterLine& line : EdgesOf(square)) {
      double s = 0.5;
      Vec3 along = Vec3::Zero();
      for (int k = 0; k < kMostIterations; ++k) {
        const FacePosition p = PositionOn(order, face, x, line.u0 + s * line.du, line.v0 + s * line.dv);
        along = line.du * p.t1 + line.dv * p.t2;
        const double next = std::clamp(s + along.dot(at - p.x) / along.squaredNorm(), 0.0, 1.0);
        const double step = std::abs(next - s);
        s = next;
        if (!(step > kEnough)) break;
      }
      const double edge_u = line.u0 + s * line.du, edge_v = line.v0 + s * line.dv;
      const double squared = (PositionOn(order, face, x, edge_u, edge_v).x - at).squaredNorm();
      if (!(squared < best.squared)) continue;
      best.squared = squared;
      best.is_corner = s == 0 || s == 1;
      best.edge = best.is_corner ? Vec3(Vec3::Zero()) : Vec3(along.normalized());
      best_u = edge_u;
      best_v = edge_v;
    }
  }
  const FacePosition p = PositionOn(order, face, x, best_u, best_v);
  best.weights = FaceWeights(order, best_u, best_v);
  best.point = p.x;
  best.normal = p.t1.cross(p.t2).normalized();
  return best;
}

// A lower bound for the distance of a face: that of the ball around its corners, larger for a curved face.
double FaceSearch::LeastDistance(const NodalVector& x, std::int32_t index, const Vec3& at) const {
  constexpr double kCurved = 1.2;
  const PressureFace& face = onto_.faces[static_cast<std::size_t>(index)];
  const int corners = IsHexahedral(model_.order()) ? 4 : 3;
  Vec3 centre = Vec3::Zero();
  for (int c = 0; c < corners; ++c) centre += x[face.nodes[c]] / corners;
  double squared = 0;
  for (int c = 0; c < corners; ++c) squared = std::max(squared, (x[face.nodes[c]] - centre).squaredNorm());
  return (at - centre).norm() - kCurved * std::sqrt(squared);
}

std::optional<NearestFace> FaceSearch::Find(const NodalVector& x, std::size_t point) const {
  if (begin_[point] == begin_[point + 1]) return std::nullopt;
  const Vec3 at = from_.points[point].PositionIn(x);
  Place best;
  best.squared = reach_ * reach_;
  std::int32_t face = -1;
  double nearest_so_far = reach_;
  for (std::int32_t k = begin_[point]; k < begin_[point + 1]; ++k) {
    if (LeastDistance(x, candidates_[k], at) > nearest_so_far) continue;
    const Place place = PlaceOn(x, candidates_[k], at);
    if (!(place.squared < best.squared)) continue;
    best = place;
    face = candidates_[k];
    nearest_so_far = std::sqrt(best.squared);
  }
  if (face < 0) return std::nullopt;
  // On an edge or at a corner the sign follows from all faces there.
  Vec3 side = best.normal;
  if (!best.is_inside) {
    const double same = kSamePlace * onto_.edge;
    side.setZero();
    for (std::int32_t k = begin_[point]; k < begin_[point + 1]; ++k) {
      if (LeastDistance(x, candidates_[k], at) > nearest_so_far + same) continue;
      const Place place = PlaceOn(x, candidates_[k], at);
      if ((place.point - best.point).squaredNorm() <= same * same) side += place.normal;
    }
  }
  const Vec3 away = at - best.point;
  const double length = std::sqrt(best.squared), sign = away.dot(side) < 0 ? -1 : 1;
  NearestFace nearest;
  nearest.face = face;
  nearest.weights = best.weights;
  nearest.distance = sign * length;
  if (best.is_inside || !(length > kSamePlace * onto_.edge)) {
    nearest.normal = side.normalized();
    return nearest;
  }
  nearest.normal = sign * away / length;
  nearest.curvature =
      (Mat3::Identity() - nearest.normal * nearest.normal.transpose() - best.edge * best.edge.transpose()) /
      nearest.distance;
  return nearest;
}

}  // namespace fascicle
