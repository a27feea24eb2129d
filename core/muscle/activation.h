#ifndef FASCICLE_CORE_MUSCLE_ACTIVATION_H_
#define FASCICLE_CORE_MUSCLE_ACTIVATION_H_

#include "core/base/curve.h"
#include "core/base/problems.h"

namespace fascicle {

// First-order activation dynamics: a muscle's activation a follows its excitation u, both in [0, 1]:
//
//   da/dt = (u - a) / tau,   tau = activation_time (0.5 + 1.5 a)      where u > a
//                                  deactivation_time / (0.5 + 1.5 a)  elsewhere
//
// [Thelen 2003, Adjustment of muscle mechanics model parameters to simulate dynamic contractions in older adults, J.
// Biomech. Eng. 125, eqs. 1, 2]
struct ActivationDynamics {
  double activation_time = 0.010;    // [s]
  double deactivation_time = 0.040;  // [s]
  double initial_activation = 0;     // at time 0
};

// The activation from time 0 until it is at rest after the excitation's last change, at most until `duration` [s]. The
// curve is piecewise linear and within 1e-4 of the solution. Adds a problem (with an empty path) and returns a constant
// curve if more than 10,000 points were needed, the most that a curve of a scene may have.
Curve ActivationOf(const Curve& excitation, const ActivationDynamics& dynamics, double duration, Problems& problems);

}  // namespace fascicle

#endif  // FASCICLE_CORE_MUSCLE_ACTIVATION_H_
