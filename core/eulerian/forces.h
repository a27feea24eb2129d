#ifndef FASCICLE_CORE_EULERIAN_FORCES_H_
#define FASCICLE_CORE_EULERIAN_FORCES_H_

#include <algorithm>
#include <vector>

#include "core/eulerian/cells.h"
#include "core/eulerian/extrapolation.h"

namespace fascicle {

// Lumped mass [kg] and forces [N] of the nodes inside of the solid, and of held ones; zero elsewhere. Nodes outside
// that solid cells have as corners follow those inside by ExtrapolationWeights; their masses and forces are theirs,
// each by its weight, so that slivers of cells neither move by themselves nor fray the surface, and momentum is kept
// [Badia, Verdugo & Martin 2018, the aggregated unfitted finite element method].
struct NodalForces {
  std::vector<double> mass;
  std::vector<double> own_mass;  // before others follow [kg]
  std::vector<Vec3> force;
  std::vector<std::uint8_t> inside;   // of each node: 1 where it is inside and has mass
  std::vector<std::int32_t> support;  // of each node: what holds it, inside or not; -1: nothing
  // Nodes outside that follow others, ascending, and of each node its number among them; -1: it does not follow.
  struct Follower {
    std::size_t node;
    std::vector<NodeWeight> leaders;
  };
  std::vector<Follower> followers;
  std::vector<std::int32_t> follower_of;

  // Calls body(node, weight) for those whose velocities make that of a node: itself, or whom it follows.
  template <class Body>
  void ForMovers(std::size_t node, const Body& body) const {
    if (mass[node] > 0) body(node, 1.0);
    if (follower_of[node] < 0) return;
    for (const NodeWeight& part : followers[follower_of[node]].leaders) body(part.node, part.weight);
  }
  bool moves(std::size_t node) const { return inside[node] != 0 || support[node] >= 0 || follower_of[node] >= 0; }
};

// Sorts parts by their nodes and adds those of one node up.
//   add(sum, part)  adds a part to another of the same node
template <class Part, class Add>
void MergeByNode(std::vector<Part>& parts, const Add& add) {
  const auto do_not_rise = [](const Part& a, const Part& b) { return a.node >= b.node; };
  if (std::adjacent_find(parts.begin(), parts.end(), do_not_rise) == parts.end()) return;
  std::stable_sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) { return a.node < b.node; });
  std::size_t count = 0;
  for (const Part& part : parts) {
    if (count > 0 && parts[count - 1].node == part.node) {
      add(parts[count - 1], part);
    } else {
      parts[count++] = part;
    }
  }
  parts.resize(count);
}

// The fibre and activation in a cell.
FibreState FibreOf(const EulerianBody& body, const EulerianState& state, const GridIndex& cell);
// The elastic part Fe = F Fp^-1 of a solid cell's deformation gradient; F where nothing is plastic.
Mat3 ElasticGradient(const EulerianBody& body, const EulerianState& state, const EulerianCells& cells,
                     std::size_t cell);
// sigma = P Fe^T / det Fe [Pa]; without the pressure that preserves volumes.
Mat3 CauchyStress(const EulerianBody& body, const Mat3& Fe, const FibreState& fibre);

// The four patterns of corners that the gradient at the centre does not see: yz, zx, xy and xyz; +-1 at corner c.
inline constexpr int kPatterns = 4;
int CornerPattern(int pattern, int c);
// Their stiffness k: an energy of 1/2 k |g|^2 for g = 1/8 sum of +-X [N/m].
double PatternStiffness(const EulerianBody& body, double volume);

// m = sum of rho0/J times an eighth of the solid part of each cell around a node; f = sum of -V sigma grad N, with
// sigma = P F^T / J of the elastic F and V the solid part, of gravity, of given forces, and of damping [Fan 2013, 3.1].
void SetForces(const EulerianBody& body, const EulerianState& state, const EulerianCells& cells, ThreadTeam& team,
               NodalForces& nodes);

// Elastic energy of the solid [J].
double ElasticEnergy(const EulerianBody& body, const EulerianState& state, const EulerianCells& cells);
double KineticEnergy(const EulerianState& state, const NodalForces& nodes);  // [J]

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_FORCES_H_
