#ifndef FASCICLE_CORE_EULERIAN_SURFACE_H_
#define FASCICLE_CORE_EULERIAN_SURFACE_H_

#include <vector>

#include "core/eulerian/cells.h"
#include "core/eulerian/interpolation.h"

namespace fascicle {

// Finds the vertices of the material surface in space: x with X(x) = X_v, by x += F (X_v - X(x)) from where
// state.surface has them [Fan 2013, 3.3]. They do not drift: their positions follow from the reference map alone.
// Returns the greatest |X_v - X(x)| that is left [m]; infinite where a vertex has left what is known of the map, and
// then stays.
double FindSurface(const EulerianBody& body, ThreadTeam& team, EulerianState& state);

// The same for one point of the material, from a place near it.
double FindPoint(const EulerianGrid& grid, const KnownField& map, const Vec3& X, Vec3& place);

// The volume that the surface encloses [m^3], by the divergence theorem.
double SurfaceVolume(const EulerianBody& body, const EulerianState& state);

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_SURFACE_H_
