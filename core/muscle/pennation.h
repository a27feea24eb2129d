#ifndef FASCICLE_CORE_MUSCLE_PENNATION_H_
#define FASCICLE_CORE_MUSCLE_PENNATION_H_

#include <optional>

#include "core/base/problems.h"
#include "core/muscle/fibre_field.h"

namespace fascicle {

// How the fibres of a pennate muscle lie at an angle to its line of action.
struct Pennation {
  double angle = 0;  // [rad]
  Vec3 normal;       // direction towards which fibres lean; any length but zero
  // A point of the plane across `normal` in which the fibres of a bipennate muscle meet [m]: beyond it fibres lean
  // towards `normal`, before it against it. All lean towards `normal` when absent.
  std::optional<Vec3> mirror_point;
};

// Turns every fibre a by the angle about a x n, with n the normal or, before the mirror plane, its opposite. A problem
// where fibres lie along the normal: they have no side to lean to. Tetrahedra whose centroid is in the mirror plane
// keep their fibre.
void Pennate(const TetMesh& mesh, const Pennation& pennation, FibreField& fibres, Problems& problems);

}  // namespace fascicle

#endif  // FASCICLE_CORE_MUSCLE_PENNATION_H_
