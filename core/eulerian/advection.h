#ifndef FASCICLE_CORE_EULERIAN_ADVECTION_H_
#define FASCICLE_CORE_EULERIAN_ADVECTION_H_

#include <vector>

#include "core/base/parallel.h"
#include "core/eulerian/interpolation.h"

namespace fascicle {

// What carries a field along: velocities, for how long, and which nodes are known.
struct Flow {
  const EulerianGrid* grid;
  const std::vector<std::uint8_t>* known;
  const std::vector<Vec3>* v;  // [m/s]
  double dt;                   // [s]
};

// result(x) = field(x - dt v(x - dt/2 v(x))) at the known nodes, by a midpoint step back along v [Fan 2013, 3.1; Stam
// 1999]. Where that place is not among known nodes, what stands at the node stays.
void Advect(const Flow& flow, const std::vector<Vec3>& field, ThreadTeam& team, std::vector<Vec3>& result);

// The same, corrected by half of what a step there and back again changes, within the values around the place where
// the step comes from [Selle et al. 2008, the unconditionally stable MacCormack method].
void AdvectMacCormack(const Flow& flow, const std::vector<Vec3>& field, ThreadTeam& team, std::vector<Vec3>& result);

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_ADVECTION_H_
