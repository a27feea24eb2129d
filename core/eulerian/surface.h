#ifndef FASCICLE_CORE_EULERIAN_SURFACE_H_
#define FASCICLE_CORE_EULERIAN_SURFACE_H_

#include <vector>

#include "core/eulerian/cells.h"
#include "core/eulerian/interpolation.h"

namespace fascicle {

// Moves the vertices of the material surface to their positions: x with X(x) = X_v, by x += F (X_v - X(x)) starting
// from state.surface [Fan 2013, 3.4.1]. There is no drift, because the positions follow from the reference map only.
// Returns the largest remaining |X_v - X(x)| [m]; infinite if a vertex has left the known region of the map, where it
// stays unchanged.
double FindSurface(const EulerianBody& body, ThreadTeam& team, EulerianState& state);

// The same for one material point, starting from a place near it.
double FindPoint(const EulerianGrid& grid, const KnownField& map, const Vec3& X, Vec3& place);

// The vertices of the surface in the world [m].
std::vector<Vec3> SurfaceInWorld(const EulerianBody& body, const EulerianState& state);

// The volume enclosed by the surface [m^3], by the divergence theorem.
double SurfaceVolume(const EulerianBody& body, const EulerianState& state);

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_SURFACE_H_
