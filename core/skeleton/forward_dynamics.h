#ifndef FASCICLE_CORE_SKELETON_FORWARD_DYNAMICS_H_
#define FASCICLE_CORE_SKELETON_FORWARD_DYNAMICS_H_

#include <Eigen/Core>

#include <functional>
#include <vector>

#include "core/skeleton/muscle_path.h"
#include "core/skeleton/skeleton_mechanics.h"

namespace fascicle {

// A skeleton in motion with its muscles.
struct SkeletonState {
  double time = 0;                             // [s]
  Eigen::VectorXd q, rates;                    // of the coordinates
  Eigen::VectorXd activations, fibre_lengths;  // of the muscles [1], [m]
};

// What acts at a time: excitations of the muscles, 0 to 1, and further generalized forces.
struct SkeletonInput {
  Eigen::VectorXd excitations, forces;
};

// Integrates the equations of motion, of activation and of the fibres' lengths: their tendons are elastic, and the
// fibre of a pennate muscle keeps its thickness [Thelen 2003]. By the embedded Runge-Kutta pair of Dormand and Prince
// (1980) with errors of `tolerance` relative to the largest of 1 and the state. Not thread-safe.
class ForwardDynamics {
 public:
  using Input = std::function<SkeletonInput(double time)>;

  ForwardDynamics(SkeletonMechanics& mechanics, Input input, double tolerance = 1e-6);

  // The state in which all fibres are in equilibrium with their tendons, at rest.
  SkeletonState Equilibrium(const Eigen::VectorXd& q, const Eigen::VectorXd& activations);
  // Steps to a later time. False, with the state as far as it came, if the step became too short.
  bool Advance(double end, SkeletonState& state);
  // Forces of the muscles' tendons in a state [N].
  Eigen::VectorXd TendonForces(const SkeletonState& state);

 private:
  Eigen::VectorXd Rates(double time, const Eigen::VectorXd& y);
  Eigen::VectorXd Packed(const SkeletonState& state) const;
  void Unpack(const Eigen::VectorXd& y, SkeletonState& state) const;

  SkeletonMechanics* mechanics_;
  Input input_;
  double tolerance_;
  double step_ = 1e-3;  // to try next [s]
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_SKELETON_FORWARD_DYNAMICS_H_
