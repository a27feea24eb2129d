#ifndef FASCICLE_CORE_MUSCLE_ACTIVATION_H_
#define FASCICLE_CORE_MUSCLE_ACTIVATION_H_

#include "core/base/lazy_curve.h"

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

// The steps of an integration of the dynamics from time 0, until the excitation and the activation are constant, at
// most until `duration` [s].
class ActivationPoints {
 public:
  // The excitation must outlive the points.
  ActivationPoints(const Curve& excitation, const ActivationDynamics& dynamics, double duration)
      : excitation_(&excitation), dynamics_(dynamics), duration_(duration), activation_(dynamics.initial_activation) {}

  bool AddNext(LineFitter& fitter);
  void Save(ArchiveWriter& archive) const;
  void Load(ArchiveReader& archive);

 private:
  void BeginInterval(double begin);
  double NextStep() const;

  const Curve* excitation_;
  ActivationDynamics dynamics_;
  double duration_;
  bool has_begun_ = false;
  double begin_ = 0, end_ = 0;  // of an interval between two points of the excitation [s]
  double time_ = 0;             // [s]
  double activation_;           // at this time
};

// The activation as a function of time: a polyline within 1e-4 of the solution.
class IntegratedActivation : public LazyCurve<ActivationPoints> {
 public:
  IntegratedActivation(const Curve& excitation, const ActivationDynamics& dynamics, double duration);
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_MUSCLE_ACTIVATION_H_
