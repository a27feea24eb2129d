#ifndef FASCICLE_CORE_SKELETON_HILL_MUSCLE_H_
#define FASCICLE_CORE_SKELETON_HILL_MUSCLE_H_

namespace fascicle {

// Properties of a muscle as a fibre with an elastic tendon in series, and its activation dynamics. Forces are relative
// to the largest isometric force, lengths to the optimal fibre length [Thelen 2003, Adjustment of muscle mechanics
// model parameters to simulate dynamic contractions in older adults, J. Biomech. Eng. 125].
struct HillCurves {
  double max_shortening_velocity = 10;  // [optimal fibre lengths/s]
  double tendon_strain = 0.04;          // at the largest isometric force [1]
  double passive_strain = 0.6;          // of the fibre, at which its passive force is the largest isometric one [1]
  double active_width = 0.45;           // of the active force over the length [1]
  double passive_shape = 4;             // exponent of the passive force [1]
  double velocity_shape = 0.25;         // [1]
  double lengthening_force = 1.4;       // the largest force of a lengthening muscle [1]
  double activation_time = 0.010;       // [s]
  double deactivation_time = 0.040;     // [s]
  // The laws of OpenSim before version 3, with which older results were computed: the passive force is exponential also
  // below the optimal length, the tendon's constants are rounded and it always bears a thousandth more, and the time
  // constants of the activation do not depend on it.
  bool is_early = false;

  // Active force of the fully active, isometric fibre (eq. 4).
  double Active(double length) const;
  // Passive force (eq. 3); linear beyond the passive strain.
  double Passive(double length) const;
  // Force of a tendon stretched by `strain` (eq. 5).
  double Tendon(double strain) const;
  // The velocity [optimal fibre lengths/s], positive where the fibre lengthens, at which a fibre of an activation and
  // an active isometric force bears `force` beyond its passive one (eq. 6, 7). Continued linearly where the force is
  // below 0 or beyond 0.95 of the largest of a lengthening muscle.
  double Velocity(double activation, double isometric, double force) const;
  // Force relative to the isometric one at a velocity: the inverse of the above at full activation.
  double ForceAt(double activation, double velocity) const;
  // Rate of the activation under an excitation, both 0 to 1 [1/s] (eq. 1, 2).
  double ActivationRate(double excitation, double activation) const;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_SKELETON_HILL_MUSCLE_H_
