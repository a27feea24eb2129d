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
  // Tetrahedra whose centroid is not in the solid and has the fibre of the nearest point, and how far the farthest is.
  std::size_t outside = 0;
  double farthest = 0;  // [m]
  // Tetrahedra at whose centroid the solid is turned inside out: its fibres cross there.
  std::size_t folded = 0;
};

// Unit derivative of the solid along w at the centroids of the tetrahedra [Teran 2003, 6]. Where it vanishes the
// direction is taken from the neighbours. The same bits for any number of threads. A problem (no fibres): more than
// half of the centroids are outside, or a direction is nowhere to be found.
BsplineFibreField BsplineFibres(const TetMesh& mesh, const BsplineLocator& locator, ThreadTeam& team,
                                Problems& problems);

}  // namespace fascicle

#endif  // FASCICLE_CORE_MUSCLE_BSPLINE_FIBRES_H_
