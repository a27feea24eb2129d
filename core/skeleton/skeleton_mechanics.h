#ifndef FASCICLE_CORE_SKELETON_SKELETON_MECHANICS_H_
#define FASCICLE_CORE_SKELETON_SKELETON_MECHANICS_H_

#include <Eigen/Core>

#include <memory>
#include <vector>

#include "core/skeleton/skeleton.h"

namespace fascicle {

// A force on a point of a bone, and a moment.
struct PointForce {
  int bone = 0;                // -1: the ground, on which forces have no effect
  Vec3 place = Vec3::Zero();   // in the bone's frame [m]
  Vec3 force = Vec3::Zero();   // in the world [N]
  Vec3 moment = Vec3::Zero();  // in the world [N m]
};

// The motion of a bone at one time, in the world.
struct BoneMotion {
  Pose pose;
  Vec3 velocity = Vec3::Zero();          // of the origin of its frame [m/s]
  Vec3 angular_velocity = Vec3::Zero();  // [rad/s]
};

// Kinematics and dynamics of a skeleton, by Simbody. Vectors q, its rates and generalized forces have one component for
// each coordinate: angles [rad] and torques [N m], or distances [m] and forces [N]. Calls of one object must not
// overlap.
class SkeletonMechanics {
 public:
  // Throws std::exception if Simbody does not accept the skeleton, such as an inertia that no body has.
  explicit SkeletonMechanics(const Skeleton& skeleton);
  ~SkeletonMechanics();

  const Skeleton& skeleton() const;
  // The start values of all coordinates.
  Eigen::VectorXd StartCoordinates() const;

  // Where each bone is [m].
  std::vector<Pose> Poses(const Eigen::VectorXd& q);
  // How each bone moves.
  std::vector<BoneMotion> Motions(const Eigen::VectorXd& q, const Eigen::VectorXd& rates);
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
