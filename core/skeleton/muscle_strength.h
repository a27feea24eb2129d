#ifndef FASCICLE_CORE_SKELETON_MUSCLE_STRENGTH_H_
#define FASCICLE_CORE_SKELETON_MUSCLE_STRENGTH_H_

#include "core/skeleton/line_muscle.h"

namespace fascicle {

// What the force of a muscle depends on besides its activation.
enum class MuscleStrength {
  kConstant,     // nothing: the largest isometric force
  kForceLength,  // the length of its fibres, at no speed
};

// Forces along a muscle [N].
struct MuscleForce {
  double active = 0;   // of full activation
  double passive = 0;  // always

  double At(double activation) const { return activation * active + passive; }
};

// length: of the whole path [m]. By length, the tendon has its slack length, and fibres at an angle to it keep their
// thickness [Thelen 2003, eq. 3, 4]; a muscle shorter than its tendon exerts nothing.
MuscleForce ForceOf(const LineMuscle& muscle, MuscleStrength strength, double length);

}  // namespace fascicle

#endif  // FASCICLE_CORE_SKELETON_MUSCLE_STRENGTH_H_
