#ifndef FASCICLE_CORE_MUSCLE_PENNATION_H_
#define FASCICLE_CORE_MUSCLE_PENNATION_H_

#include <optional>

#include "core/base/problems.h"
#include "core/muscle/fibre_field.h"

namespace fascicle {

// The angle of a pennate muscle's fibres to its line of action.
struct Pennation {
  double angle = 0;  // [rad]
  Vec3 normal;       // direction towards which fibres are tilted; any non-zero length
  // A point of the plane normal to `normal` at which the fibres of a bipennate muscle meet [m]. Fibres beyond the plane
  // are tilted towards `normal`, fibres before it away from it. Without it, all are tilted towards `normal`.
  std::optional<Vec3> mirror_point;
};

// Rotates every fibre a by the angle about a x n, where n is the normal or, before the mirror plane, its opposite. Adds
// a problem where fibres are parallel to the normal, since the direction of tilt is undefined. Elements whose
// centroid is in the mirror plane keep their fibre.
void Pennate(const TetMesh& mesh, const Pennation& pennation, FibreField& fibres, Problems& problems);

}  // namespace fascicle

#endif  // FASCICLE_CORE_MUSCLE_PENNATION_H_
