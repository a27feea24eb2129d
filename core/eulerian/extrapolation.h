#ifndef FASCICLE_CORE_EULERIAN_EXTRAPOLATION_H_
#define FASCICLE_CORE_EULERIAN_EXTRAPOLATION_H_

#include <vector>

#include "core/base/parallel.h"
#include "core/eulerian/grid.h"

namespace fascicle {

// A node's part in a value that is fitted.
struct NodeWeight {
  std::size_t node;
  double weight;
};

// What the value at a node is made of, of the linear function that fits the known nodes within two cells best, nearer
// ones counting more; they add up to 1. Directions in which known nodes lie flat get no slope. Empty where none is
// near.
std::vector<NodeWeight> ExtrapolationWeights(const EulerianGrid& grid, const GridIndex& at,
                                             const std::vector<std::uint8_t>& known);

// Carries a field on from the nodes where it is known into so many layers of nodes around them: each takes the mean of
// what its neighbours of the layer before say by their slopes, and the mean of these slopes. The slopes of the first
// are those of linear functions that fit the known nodes within two cells of it best. So linear fields are continued
// exactly, and others do not grow faster than that however many layers there are. Directions in which known nodes lie
// flat have the slope `slope`. known: 1 where known, and where it is in the end.
//   slope  1 for the reference map, 0 for velocities
void Extrapolate(const EulerianGrid& grid, int layers, double slope, ThreadTeam& team, std::vector<std::uint8_t>& known,
                 std::vector<Vec3>& field);

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_EXTRAPOLATION_H_
