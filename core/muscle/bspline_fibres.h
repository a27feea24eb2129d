#ifndef FASCICLE_CORE_MUSCLE_BSPLINE_FIBRES_H_
#define FASCICLE_CORE_MUSCLE_BSPLINE_FIBRES_H_

#include <cstddef>

#include "core/base/parallel.h"
#include "core/base/problems.h"
#include "core/geometry/bspline_locator.h"
#include "core/muscle/fibre_field.h"

namespace fascicle {

struct BsplineFibreField {
  FibreField fibres;
  // Tetrahedra with their centroid outside of the solid, which take the fibre of the nearest point, and the largest
  // such distance.
  std::size_t outside = 0;
  double farthest = 0;  // [m]
  // Tetrahedra at whose centroid the solid has a non-positive Jacobian: its fibres cross there.
  std::size_t folded = 0;
};

// Unit derivative of the solid along w at the centroids of the tetrahedra [Teran 2003, 6]. Where it vanishes, the
// direction is taken from the neighbours. The same bits for any number of threads. Adds a problem and returns no fibres
// if more than half of the centroids are outside, or if no direction can be determined. Observes the team's stop
// requests.
BsplineFibreField BsplineFibres(const TetMesh& mesh, const BsplineLocator& locator, ThreadTeam& team,
                                Problems& problems);

}  // namespace fascicle

#endif  // FASCICLE_CORE_MUSCLE_BSPLINE_FIBRES_H_
