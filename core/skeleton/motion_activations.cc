#include "core/skeleton/motion_activations.h"

#include "core/base/stop.h"
#include "core/skeleton/force_distribution.h"
#include "core/skeleton/joint_tree.h"
#include "core/skeleton/muscle_path.h"

namespace fascicle {
namespace {

using Eigen::Index;

// The coordinates that muscles must move.
std::vector<Index> CrossedCoordinates(const Skeleton& skeleton) {
  const JointTree tree(skeleton);
  std::vector<Index> crossed;
  for (std::size_t c = 0; c < skeleton.coordinates.size(); ++c) {
    if (skeleton.coordinates[c].locked) continue;
    for (const LineMuscle& muscle : skeleton.muscles) {
      if (!tree.Parts(static_cast<int>(c), BonesOf(skeleton, muscle))) continue;
      crossed.push_back(static_cast<Index>(c));
      break;
    }
  }
  return crossed;
}

}  // namespace

Eigen::VectorXd TorquesOf(SkeletonMechanics& mechanics, const SkeletonMotion& motion, double time, bool at_rest) {
  const Eigen::VectorXd q = motion.At(time), zero = Eigen::VectorXd::Zero(q.size());
  if (at_rest) return mechanics.InverseDynamics(q, zero, zero);
  return mechanics.InverseDynamics(q, motion.At(time, 1), motion.At(time, 2));
}

MotionActivations ActivationsOf(SkeletonMechanics& mechanics, const SkeletonMotion& motion, MuscleStrength strength,
                                const std::vector<double>& times, bool at_rest, const std::stop_token& stop) {
  const Skeleton& skeleton = mechanics.skeleton();
  const std::vector<Index> crossed = CrossedCoordinates(skeleton);
  const auto muscles = static_cast<Index>(skeleton.muscles.size()), count = static_cast<Index>(times.size());
  const auto coordinates = static_cast<Index>(skeleton.coordinates.size());
  MotionActivations result{Eigen::MatrixXd(muscles, count), Eigen::MatrixXd(coordinates, count),
                           Eigen::MatrixXd::Zero(coordinates, count)};
  ForceDistributor distributor;
  Eigen::VectorXd active(muscles), passive(muscles);
  for (Index k = 0; k < count; ++k) {
    ThrowIfStopped(stop);
    const double time = times[static_cast<std::size_t>(k)];
    const MuscleGeometry geometry = GeometryOf(mechanics, motion.At(time));
    for (Index m = 0; m < muscles; ++m) {
      const MuscleForce force = ForceOf(skeleton.muscles[static_cast<std::size_t>(m)], strength, geometry.lengths[m]);
      active[m] = force.active;
      passive[m] = force.passive;
    }
    result.torques.col(k) = TorquesOf(mechanics, motion, time, at_rest);
    const Eigen::VectorXd demand = result.torques.col(k) - geometry.moment_arms * passive;
    const Eigen::MatrixXd capacity = geometry.moment_arms * active.asDiagonal();
    const Distribution found = distributor.Solve(capacity(crossed, Eigen::all), demand(crossed));
    result.activations.col(k) = found.activations;
    result.lack(crossed, k) = found.lack;
  }
  return result;
}

}  // namespace fascicle
