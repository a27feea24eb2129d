#include "core/skeleton/muscle_path.h"

#include <algorithm>
#include <cstddef>
#include <optional>

namespace fascicle {
namespace {

using Point = MusclePath::Point;

Vec3 ToWorld(const Pose& pose, const Vec3& place) { return pose.position + RotationOf(pose) * place; }
Vec3 ToLocal(const Pose& pose, const Vec3& world) { return RotationOf(pose).transpose() * (world - pose.position); }

class PathBuilder {
 public:
  PathBuilder(const Skeleton& skeleton, const LineMuscle& muscle, const Eigen::VectorXd& q,
              const std::vector<Pose>& poses)
      : skeleton_(skeleton), muscle_(muscle), q_(q), poses_(poses) {}

  MusclePath Build() {
    for (std::size_t k = 0; k < muscle_.points.size(); ++k) AddPoint(k);
    for (std::size_t k = 0; k < muscle_.wraps.size(); ++k) AddWrap(k);
    for (std::size_t k = 0; k + 1 < path_.points.size(); ++k) {
      if (!path_.points[k].on_surface) path_.length += (path_.points[k + 1].world - path_.points[k].world).norm();
    }
    return std::move(path_);
  }

 private:
  Pose PoseOf(int bone) const { return bone < 0 ? Pose() : poses_[static_cast<std::size_t>(bone)]; }

  void AddPoint(std::size_t number) {
    const PathPoint& point = muscle_.points[number];
    if (point.condition >= 0) {
      const double at = q_[point.condition];
      if (at < point.range[0] || at > point.range[1]) return;
    }
    Vec3 place = point.place;
    for (int i = 0; i < 3; ++i) {
      const auto axis = static_cast<std::size_t>(i);
      if (point.moved_by[axis] >= 0) place[i] = point.moved[axis].At(q_[point.moved_by[axis]]);
    }
    path_.points.push_back({point.bone, place, ToWorld(PoseOf(point.bone), place), false});
    numbers_.push_back(static_cast<int>(number));
  }

  struct Touch {
    std::size_t after = 0;  // index of the point before it
    Wrapping wrapping;      // in the surface's frame
    double added = 0;       // length, compared with the straight line [m]
  };

  void AddWrap(std::size_t number) {
    const PathWrap& wrap = muscle_.wraps[number];
    const WrapSurface& surface = skeleton_.surfaces[static_cast<std::size_t>(wrap.surface)];
    const Pose bone = PoseOf(surface.bone);
    const auto to_surface = [&](const Point& point) { return ToLocal(surface.pose, ToLocal(bone, point.world)); };
    std::optional<Touch> best;
    for (std::size_t k = 0; k + 1 < path_.points.size(); ++k) {
      if (path_.points[k].on_surface || numbers_[k] < wrap.first || numbers_[k + 1] > wrap.last) continue;
      // A part between two points of one bone always has the same course, which its points describe.
      if (path_.points[k].bone == path_.points[k + 1].bone && path_.points[k].bone == surface.bone) continue;
      const Vec3 a = to_surface(path_.points[k]), b = to_surface(path_.points[k + 1]);
      const auto wrapping = Wrap(surface, a, b);
      if (!wrapping) continue;
      const double added =
          (wrapping->first - a).norm() + wrapping->length + (b - wrapping->last).norm() - (b - a).norm();
      if (!best || added > best->added) best = Touch{k, *wrapping, added};
    }
    if (!best) return;
    const auto at = static_cast<std::ptrdiff_t>(best->after) + 1;
    const auto point = [&](const Vec3& on_surface, bool begins) {
      const Vec3 place = ToWorld(surface.pose, on_surface);
      return Point{surface.bone, place, ToWorld(bone, place), begins};
    };
    path_.points.insert(path_.points.begin() + at,
                        {point(best->wrapping.first, true), point(best->wrapping.last, false)});
    numbers_.insert(numbers_.begin() + at, {numbers_[best->after], numbers_[best->after + 1]});
    path_.length += best->wrapping.length;
    path_.touched.push_back(static_cast<int>(number));
  }

  const Skeleton& skeleton_;
  const LineMuscle& muscle_;
  const Eigen::VectorXd& q_;
  const std::vector<Pose>& poses_;
  MusclePath path_;
  std::vector<int> numbers_;  // of each point, among those of the muscle; of a surface's: its neighbours'
};

}  // namespace

std::vector<PointForce> MusclePath::UnitForces() const {
  std::vector<PointForce> forces;
  for (std::size_t k = 0; k + 1 < points.size(); ++k) {
    const Point &a = points[k], &b = points[k + 1];
    if (a.on_surface || a.bone == b.bone) continue;
    const Vec3 along = (b.world - a.world).normalized();
    forces.push_back({a.bone, a.place, along});
    forces.push_back({b.bone, b.place, -along});
  }
  return forces;
}

MusclePath PathOf(const Skeleton& skeleton, const LineMuscle& muscle, const Eigen::VectorXd& q,
                  const std::vector<Pose>& poses) {
  return PathBuilder(skeleton, muscle, q, poses).Build();
}

MuscleGeometry GeometryOf(SkeletonMechanics& mechanics, const Eigen::VectorXd& q) {
  const Skeleton& skeleton = mechanics.skeleton();
  const std::vector<Pose> poses = mechanics.Poses(q);
  const auto muscles = static_cast<Eigen::Index>(skeleton.muscles.size());
  MuscleGeometry geometry{Eigen::VectorXd(muscles), Eigen::MatrixXd(q.size(), muscles)};
  for (Eigen::Index m = 0; m < muscles; ++m) {
    const MusclePath path = PathOf(skeleton, skeleton.muscles[static_cast<std::size_t>(m)], q, poses);
    geometry.lengths[m] = path.length;
    geometry.moment_arms.col(m) = mechanics.GeneralizedForces(q, path.UnitForces());
  }
  return geometry;
}

}  // namespace fascicle
