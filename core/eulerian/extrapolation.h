#ifndef FASCICLE_CORE_EULERIAN_EXTRAPOLATION_H_
#define FASCICLE_CORE_EULERIAN_EXTRAPOLATION_H_

#include <vector>

#include "core/base/parallel.h"
#include "core/eulerian/grid.h"

namespace fascicle {

// The weight of a node in a fitted value.
struct NodeWeight {
  std::size_t node;
  double weight;
};

// The weights that extrapolate to a node: of the linear least squares fit to the known nodes within two cells, nearer
// ones weighing more. They add up to 1. Directions in which the known nodes are coplanar have slope zero. Empty where
// no known node is near.
std::vector<NodeWeight> ExtrapolationWeights(const EulerianGrid& grid, const GridIndex& at,
                                             const std::vector<std::uint8_t>& known);

// Layers of nodes around those where fields are known, each of the nodes beside the layer before. Const, it may be used
// by several threads.
class Band {
 public:
  // known: of each node, 1 where fields are known. `grid` must outlive it.
  Band(const EulerianGrid& grid, const std::vector<std::uint8_t>& known, int layers, ThreadTeam& team);

  // Of each node, 1 where fields are known or in the first so many layers.
  std::vector<std::uint8_t> Known(int layers) const;

  // Extrapolates a field into the first so many layers: each node takes the mean of what its neighbours of the layer
  // before extrapolate by their slopes, and the mean of these slopes. The slopes of the first are those of linear least
  // squares fits to the known nodes within two cells. So linear fields are continued exactly, and others grow no faster
  // than linearly, however many layers there are. Directions in which the known nodes are coplanar have the slope
  // `slope`.
  //   slope  1 for the reference map, 0 for velocities
  void Extend(int layers, double slope, ThreadTeam& team, std::vector<Vec3>& field) const;

 private:
  using Places = std::vector<std::size_t>;  // nodes
  Places Front(ThreadTeam& team) const;
  Places Beside(const Places& before, int layer, ThreadTeam& team);
  std::size_t NodeCount(int layers) const;

  const EulerianGrid* grid_;
  std::vector<std::uint8_t> layer_;  // of each node: 1 + its layer, 1 where it is known, 0 beyond
  std::vector<Places> places_;       // of each layer; the first: known nodes beside others
  std::vector<int> number_of_;       // of each node in places_: its number there
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_EXTRAPOLATION_H_
