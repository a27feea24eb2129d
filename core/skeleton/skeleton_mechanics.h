#ifndef FASCICLE_CORE_SKELETON_SKELETON_MECHANICS_H_
#define FASCICLE_CORE_SKELETON_SKELETON_MECHANICS_H_

#include <Eigen/Core>

#include <memory>
#include <vector>

#include "core/skeleton/skeleton.h"

namespace fascicle {

// A force on a point of a bone.
struct PointForce {
  int bone = 0;               // -1: the ground, on which forces have no effect
  Vec3 place = Vec3::Zero();  // in the bone's frame [m]
  Vec3 force = Vec3::Zero();  // in the world [N]
};

// Kinematics and dynamics of a skeleton, by Simbody. Vectors q, its rates and generalized forces have one component for
// each coordinate: angles [rad] and torques [N m], or distances [m] and forces [N]. Calls of one object must not
// overlap.
class SkeletonMechanics {
 public:
  explicit SkeletonMechanics(const Skeleton& skeleton);
  ~SkeletonMechanics();

  const Skeleton& skeleton() const;
  // The start values of all coordinates.
  Eigen::VectorXd StartCoordinates() const;

  // Where each bone is [m].
  std::vector<Pose> Poses(const Eigen::VectorXd& q);
  // The generalized forces that do the work of given forces: sum of J^T f.
  Eigen::VectorXd GeneralizedForces(const Eigen::VectorXd& q, const std::vector<PointForce>& forces);
  // The generalized forces that joints must exert for given accelerations, against gravity and inertia.
  Eigen::VectorXd InverseDynamics(const Eigen::VectorXd& q, const Eigen::VectorXd& rates,
                                  const Eigen::VectorXd& accelerations);
  // The accelerations under given generalized forces and gravity. Locked coordinates have none.
  Eigen::VectorXd Accelerations(const Eigen::VectorXd& q, const Eigen::VectorXd& rates, const Eigen::VectorXd& forces);
  // Kinetic plus gravitational potential energy [J].
  double Energy(const Eigen::VectorXd& q, const Eigen::VectorXd& rates);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_SKELETON_SKELETON_MECHANICS_H_
