#include "core/skeleton/muscle_strength.h"

#include <cmath>

namespace fascicle {

MuscleForce ForceOf(const LineMuscle& muscle, MuscleStrength strength, double length) {
  if (strength == MuscleStrength::kConstant) return {muscle.max_isometric_force, 0};
  const double along = length - muscle.tendon_slack_length;
  if (!(along > 0)) return {};
  const double thickness = muscle.optimal_fibre_length * std::sin(muscle.pennation);
  const double fibre = std::hypot(along, thickness);
  const double full = muscle.max_isometric_force * along / fibre, relative = fibre / muscle.optimal_fibre_length;
  return {full * muscle.hill.Active(relative), full * muscle.hill.Passive(relative)};
}

}  // namespace fascicle
