#ifndef FASCICLE_CORE_EULERIAN_EXTRAPOLATION_H_
#define FASCICLE_CORE_EULERIAN_EXTRAPOLATION_H_

#include <vector>

#include "core/base/parallel.h"
#include "core/eulerian/grid.h"

namespace fascicle {

// A node and its weight in an extrapolated value.
struct NodeWeight {
  std::size_t node;
  double weight;
};

// The weights of the value at a node that extrapolates the known nodes within two cells by a linear least squares fit;
// nearer nodes have larger weights. They add up to 1. Directions in which the known nodes are coplanar have slope zero.
// Empty if no known node is near.
std::vector<NodeWeight> ExtrapolationWeights(const EulerianGrid& grid, const GridIndex& at,
                                             const std::vector<std::uint8_t>& known);

// The extrapolation band: layers of nodes around those where fields are known; each layer has the neighbours of the
// previous one. Const, thread-safe.
class Band {
 public:
  // known: for each node, 1 where fields are known. `grid` must outlive the band.
  Band(const EulerianGrid& grid, const std::vector<std::uint8_t>& known, int layers, ThreadTeam& team);

  // For each node, 1 where fields are known or in the given number of layers.
  std::vector<std::uint8_t> Known(int layers) const;

  // Extrapolates a field to the given number of layers. Each node takes the mean of its neighbours in the previous
  // layer, each extrapolated by its slope, and the mean of their slopes. The slopes of the first layer are those of
  // linear least squares fits to the known nodes within two cells. So linear fields are extrapolated exactly, and other
  // fields grow at most linearly, whatever the number of layers. Directions in which the known nodes are coplanar have
  // the slope `slope`.
  //   slope  1 for the reference map, 0 for velocities
  void Extend(int layers, double slope, ThreadTeam& team, std::vector<Vec3>& field) const;

 private:
  using Places = std::vector<std::size_t>;  // nodes
  Places Front(ThreadTeam& team) const;
  Places Beside(const Places& before, int layer, ThreadTeam& team);
  std::size_t NodeCount(int layers) const;

  const EulerianGrid* grid_;
  std::vector<std::uint8_t> layer_;  // for each node: 1 + its layer, 1 where it is known, 0 beyond
  std::vector<Places> places_;       // the nodes of each layer; the first: known nodes with unknown neighbours
  std::vector<int> number_of_;       // for each node in places_: its index there
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_EXTRAPOLATION_H_
