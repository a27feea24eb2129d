#ifndef FASCICLE_CORE_MUSCLE_STERN_MUSCLE_H_
#define FASCICLE_CORE_MUSCLE_STERN_MUSCLE_H_

#include <cstddef>
#include <vector>

#include "core/base/lazy_curve.h"

namespace fascicle {

// A muscle with parallel fibres across one joint, attached at distances B and C from the joint.
struct SternMuscle {
  double origin_distance = 0;       // B > 0 [m]
  double insertion_distance = 0;    // C > 0 [m]
  double peak_force = 0;            // P0 at the length L0 > 0 [N]
  double optimal_angle = 0;         // joint angle at L0, in (0, pi] [rad]
  double contractile_fraction = 1;  // Y in (0, 1]: contractile part of the muscle's length at L0; the rest is tendon
  double hill_curvature = 0.25;     // Hill's a over P0 > 0
  double hill_rate = 2.5;           // Hill's b = j > 0 [contractile lengths at L0 per second]
  double eccentric_force = 1.4;     // plateau of the lengthening force over P0 > 1
};

// Distance between the attachments, L = sqrt(B^2 + C^2 - 2 B C cos(angle)) [m].
double LengthOf(const SternMuscle& muscle, double angle);

// Force of the muscle [N] at a joint angle [rad] that opens at `rate` [rad/s] (which lengthens the muscle) and at an
// activation alpha in [0, 1]:
//
//   P = P0(l) { (1/a + 1) / [1 + v / (j Y Kl)] - 1 } a alpha,   v = B C sin(angle) shortening / (L (B + C))
//
// [Stern 1974, Computer modelling of gross muscle dynamics, J. Biomech. 7; Zhu, Chen & Kaufman 1998, eq. 1,
// misprinted]. This is Hill's hyperbola in the velocity of the contractile part; L = Ki (B + C), Kl = Ki at the optimal
// angle. P0(l) is peak_force times the ActiveCurve of the contractile length relative to that at L0, with a tendon of
// constant length. Lengthening follows ForceVelocityCurve, because Stern's formula is unbounded there.
double ForceOf(const SternMuscle& muscle, double angle, double rate, double activation);

// The inputs of such a muscle over time.
struct SternDrive {
  Curve angle = Curve::Constant(0);       // of the joint [rad]
  Curve activation = Curve::Constant(1);  // in [0, 1]
};

// Samples of the muscle's force from time 0 to `duration` [s].
class SternForcePoints {
 public:
  // The drive must outlive the points.
  SternForcePoints(const SternMuscle& muscle, const SternDrive& drive, double duration);

  bool AddNext(LineFitter& fitter);
  void Save(ArchiveWriter& archive) const;
  void Load(ArchiveReader& archive);

 private:
  SternMuscle muscle_;
  const SternDrive* drive_;
  std::vector<double> bends_;  // times between which both curves are smooth [s]
  std::size_t piece_ = 0;      // the interval between bends_[piece_] and the next
  int sample_ = 0;             // the next sample in it
};

// The muscle's force as a function of time [N]: a polyline within 2e-4 peak_force of the force.
class SternForce : public LazyCurve<SternForcePoints> {
 public:
  SternForce(const SternMuscle& muscle, const SternDrive& drive, double duration);
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_MUSCLE_STERN_MUSCLE_H_
