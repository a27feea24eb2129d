#ifndef FASCICLE_CORE_SKELETON_MOTION_ACTIVATIONS_H_
#define FASCICLE_CORE_SKELETON_MOTION_ACTIVATIONS_H_

#include <Eigen/Core>

#include <stop_token>
#include <vector>

#include "core/skeleton/muscle_strength.h"
#include "core/skeleton/skeleton_mechanics.h"
#include "core/skeleton/skeleton_motion.h"

namespace fascicle {

// The torques that joints need in a pose of a motion, from Simbody's inverse dynamics.
Eigen::VectorXd TorquesOf(SkeletonMechanics& mechanics, const SkeletonMotion& motion, double time, bool at_rest);

// Activations that exert the torques of a motion, and what they lack.
struct MotionActivations {
  Eigen::MatrixXd activations;  // muscles x times
  Eigen::MatrixXd torques;      // that joints need: coordinates x times [N m or N]
  // What muscles cannot exert of them, about the coordinates that they cross; 0 about the others and locked ones.
  Eigen::MatrixXd lack;
};

// Distributes forces (force_distribution.h) at each of `times`, which ascend. at_rest: the torques are those of rest in
// each pose [Teran 2003, 7]. Locked coordinates, and those that no muscle crosses, need no muscle. Throws Stopped after
// a stop request.
MotionActivations ActivationsOf(SkeletonMechanics& mechanics, const SkeletonMotion& motion, MuscleStrength strength,
                                const std::vector<double>& times, bool at_rest, const std::stop_token& stop = {});

}  // namespace fascicle

#endif  // FASCICLE_CORE_SKELETON_MOTION_ACTIVATIONS_H_
