#ifndef FASCICLE_CORE_EULERIAN_SURFACE_H_
#define FASCICLE_CORE_EULERIAN_SURFACE_H_

#include <vector>

#include "core/eulerian/cells.h"

namespace fascicle {

// Where the vertices of the material surface are in space: x with X(x) = X_v, by x += F (X_v - X(x)) from where they
// were [Fan 2013, 3.3]. It has no drift, since nothing but the reference map tells the places.
//   vertices  of body.shape.surface().nodes: a place near, and the result [m]
// The greatest |X_v - X(x)| that is left [m]; infinite where a vertex has left what is known of the map.
double CarrySurface(const EulerianBody& body, const EulerianState& state, ThreadTeam& team,
                    std::vector<Vec3>& vertices);

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_SURFACE_H_
