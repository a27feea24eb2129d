#include "core/geometry/bspline_locator.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unsupported/Eigen/BVH>
#include <utility>

namespace fascicle {
namespace {

constexpr double kRoundOff = 1e-13;  // distance at which Newton's method stops, relative to the solid's diagonal
constexpr double kInside = 1e-9;     // distance that counts as zero, relative to the diagonal
constexpr int kSamplesPerSpan = 2;

// A point of the solid, as a starting point for Newton's method.
struct Sample {
  Vec3 position, parameters;
};

Eigen::AlignedBox3d bounding_box(const Sample& sample) { return Eigen::AlignedBox3d(sample.position); }

// The sample parameters of one direction: the midpoints of equal parts of each non-empty knot span.
std::vector<double> SampleParameters(const BsplineBasis& basis) {
  std::vector<double> parameters;
  const std::vector<double>& knots = basis.knots();
  for (std::size_t i = 1; i < knots.size(); ++i) {
    if (knots[i] == knots[i - 1]) continue;
    for (int s = 0; s < kSamplesPerSpan; ++s) {
      parameters.push_back(knots[i - 1] + (s + 0.5) / kSamplesPerSpan * (knots[i] - knots[i - 1]));
    }
  }
  return parameters;
}

std::vector<Sample> MakeSamples(const BsplineSolid& solid) {
  const auto along_u = SampleParameters(solid.bases()[0]), along_v = SampleParameters(solid.bases()[1]),
             along_w = SampleParameters(solid.bases()[2]);
  std::vector<Sample> samples;
  samples.reserve(along_u.size() * along_v.size() * along_w.size());
  for (const double w : along_w) {
    for (const double v : along_v) {
      for (const double u : along_u) samples.push_back({solid.At({u, v, w}).position, {u, v, w}});
    }
  }
  return samples;
}

double SolidDiagonal(const BsplineSolid& solid) {
  Eigen::AlignedBox3d box;
  for (const Vec3& q : solid.controls()) box.extend(q);
  return box.diagonal().norm();
}

// A visitor of Eigen's bounding volume tree that keeps the samples nearest to a point.
struct NearestSamples {
  using Scalar = double;
  static constexpr std::size_t kCount = 4;
  struct Candidate {
    double squared_distance = std::numeric_limits<double>::infinity();
    Vec3 parameters;
  };

  double minimumOnVolume(const Eigen::AlignedBox3d& box) const { return box.squaredExteriorDistance(point); }
  // Lets the tree skip samples that are farther away than the last one kept.
  double minimumOnObject(const Sample& sample) {
    const Candidate candidate{(sample.position - point).squaredNorm(), sample.parameters};
    const auto nearer = [](const Candidate& a, const Candidate& b) { return a.squared_distance < b.squared_distance; };
    const auto place = std::upper_bound(kept.begin(), kept.end(), candidate, nearer);
    if (place != kept.end()) {
      std::move_backward(place, kept.end() - 1, kept.end());
      *place = candidate;
    }
    return kept.back().squared_distance;
  }

  Vec3 point;
  std::array<Candidate, kCount> kept;
};

// Newton's method for one point. Parameters are scaled to the unit box.
class Descent {
 public:
  Descent(const BsplineSolid& solid, double tolerance, const Vec3& target)
      : solid_(solid), range_(solid.highest() - solid.lowest()), tolerance_(tolerance), target_(target) {}

  BsplineLocation From(const Vec3& parameters) const {
    constexpr int kMaxSteps = 60;
    constexpr double kLeastDamping = 1e-4, kMostDamping = 1e6, kSmallestStep = 1e-14;
    Vec3 s = (parameters - solid_.lowest()).cwiseQuotient(range_);
    State state = At(s);
    double damping = 0;
    for (int step = 0; step < kMaxSteps && state.distance > tolerance_ && damping < kMostDamping; ++step) {
      const Vec3 trial = (s + Direction(s, state, damping)).cwiseMax(0).cwiseMin(1);
      if ((trial - s).cwiseAbs().maxCoeff() < kSmallestStep) break;
      const State next = At(trial);
      if (next.distance < state.distance) {
        s = trial;
        state = next;
        damping = damping > kLeastDamping ? damping / 10 : 0;
      } else {
        damping = std::max(kLeastDamping, 10 * damping);
      }
    }
    return {solid_.lowest() + s.cwiseProduct(range_), state.distance, false};
  }

 private:
  struct State {
    Vec3 offset;  // from the solid to the target [m]
    Mat3 gradients;
    double distance;
  };

  State At(const Vec3& s) const {
    const BsplineSolid::Point point = solid_.At(solid_.lowest() + s.cwiseProduct(range_));
    const Vec3 offset = target_ - point.position;
    return {offset, point.gradients * range_.asDiagonal(), offset.norm()};
  }

  // The damped step, restricted to directions that stay within the box.
  static Vec3 Direction(const Vec3& s, const State& state, double damping) {
    Vec3 descent = state.gradients.transpose() * state.offset;
    Mat3 normal = state.gradients.transpose() * state.gradients;
    normal.diagonal() *= 1 + damping;
    for (int i = 0; i < 3; ++i) {
      if (!((s[i] <= 0 && descent[i] < 0) || (s[i] >= 1 && descent[i] > 0))) continue;
      descent[i] = 0;
      normal.row(i).setZero();
      normal.col(i).setZero();
      normal(i, i) = 1;
    }
    const Vec3 direction = normal.ldlt().solve(descent);
    return direction.allFinite() ? direction : Vec3(Vec3::Zero());
  }

  const BsplineSolid& solid_;
  Vec3 range_;
  double tolerance_;
  Vec3 target_;
};

}  // namespace

struct BsplineLocator::Impl {
  explicit Impl(BsplineSolid the_solid) : solid(std::move(the_solid)), diagonal(SolidDiagonal(solid)) {
    const std::vector<Sample> samples = MakeSamples(solid);
    tree.init(samples.begin(), samples.end());
  }

  BsplineSolid solid;
  double diagonal;  // of the control points' box [m]
  Eigen::KdBVH<double, 3, Sample> tree;
};

BsplineLocator::BsplineLocator(BsplineSolid solid) : impl_(std::make_unique<Impl>(std::move(solid))) {}
BsplineLocator::~BsplineLocator() = default;

const BsplineSolid& BsplineLocator::solid() const { return impl_->solid; }

BsplineLocation BsplineLocator::Locate(const Vec3& point) const {
  NearestSamples nearest{.point = point, .kept = {}};
  Eigen::BVMinimize(impl_->tree, nearest);
  const Descent descent(impl_->solid, kRoundOff * impl_->diagonal, point);
  BsplineLocation best{Vec3::Zero(), std::numeric_limits<double>::infinity(), false};
  for (const NearestSamples::Candidate& start : nearest.kept) {
    if (!std::isfinite(start.squared_distance)) break;
    const BsplineLocation found = descent.From(start.parameters);
    if (found.distance < best.distance) best = found;
    best.inside = best.distance <= kInside * impl_->diagonal;
    if (best.inside) break;
  }
  return best;
}

std::vector<BsplineLocation> BsplineLocator::Locate(std::span<const Vec3> points, ThreadTeam& team) const {
  constexpr std::size_t kGrain = 64;
  std::vector<BsplineLocation> locations(points.size());
  ForEach(team, points.size(), kGrain, [&](std::size_t i) { locations[i] = Locate(points[i]); });
  return locations;
}

}  // namespace fascicle
