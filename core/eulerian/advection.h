#ifndef FASCICLE_CORE_EULERIAN_ADVECTION_H_
#define FASCICLE_CORE_EULERIAN_ADVECTION_H_

#include <vector>

#include "core/base/parallel.h"
#include "core/eulerian/interpolation.h"

namespace fascicle {

// A flow: velocities, a time, and the nodes at which they are known.
struct Flow {
  const EulerianGrid* grid;
  const std::vector<std::uint8_t>* known;
  const std::vector<Vec3>* v;  // [m/s]
  double dt;                   // [s]
};

// result(x) = field(x - dt v(x - dt/2 v(x))) at the known nodes, by a midpoint step back along v [Fan 2013, 3.2; Stam
// 1999]. If that place is not among known nodes, the node keeps its value.
void Advect(const Flow& flow, const std::vector<Vec3>& field, ThreadTeam& team, std::vector<Vec3>& result);

// The same, corrected by half the error of a step forth and back, and limited to the values around the departure point
// [Selle et al. 2008, An unconditionally stable MacCormack method, J. Sci. Comput. 35].
void AdvectMacCormack(const Flow& flow, const std::vector<Vec3>& field, ThreadTeam& team, std::vector<Vec3>& result);

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_ADVECTION_H_
