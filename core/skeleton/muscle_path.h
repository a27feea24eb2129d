#ifndef FASCICLE_CORE_SKELETON_MUSCLE_PATH_H_
#define FASCICLE_CORE_SKELETON_MUSCLE_PATH_H_

#include <Eigen/Core>

#include <vector>

#include "core/skeleton/skeleton.h"
#include "core/skeleton/skeleton_mechanics.h"

namespace fascicle {

// The course of a muscle in one pose of its skeleton: points from its origin to its insertion.
struct MusclePath {
  struct Point {
    int bone = 0;               // -1: the ground
    Vec3 place = Vec3::Zero();  // in the bone's frame [m]
    Vec3 world = Vec3::Zero();  // [m]
    // The part up to the next point lies on a surface of the bone. It has no effect on other bones.
    bool on_surface = false;
  };

  std::vector<Point> points;
  double length = 0;  // [m]
  // Index of each wrap of the muscle whose surface is touched.
  std::vector<int> touched;

  // What a tension of 1 N does: a pair of forces for each free straight part [N].
  std::vector<PointForce> UnitForces() const;
};

// The shortest way over all points of a muscle around its surfaces. Each surface is touched at most once, where that
// lengthens the muscle most. `poses`: of the bones.
MusclePath PathOf(const Skeleton& skeleton, const LineMuscle& muscle, const Eigen::VectorXd& q,
                  const std::vector<Pose>& poses);

// Length of every muscle and its moment arm about every coordinate, r = -dL/dq: positive where tension increases the
// coordinate. By the principle of virtual work: the generalized force of a unit tension.
struct MuscleGeometry {
  Eigen::VectorXd lengths;      // one for each muscle [m]
  Eigen::MatrixXd moment_arms;  // coordinates x muscles [m] of an angle, [1] of a distance
};
MuscleGeometry GeometryOf(SkeletonMechanics& mechanics, const Eigen::VectorXd& q);

}  // namespace fascicle

#endif  // FASCICLE_CORE_SKELETON_MUSCLE_PATH_H_
