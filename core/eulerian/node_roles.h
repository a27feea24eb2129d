#ifndef FASCICLE_CORE_EULERIAN_NODE_ROLES_H_
#define FASCICLE_CORE_EULERIAN_NODE_ROLES_H_

#include <algorithm>
#include <vector>

#include "core/eulerian/cells.h"
#include "core/eulerian/extrapolation.h"

namespace fascicle {

// How the velocity of each node of the grid is determined:
//   free         inside of the solid: it is an unknown
//   prescribed   a corner of a solid cell within a support: by the support's motion
//   constrained  any other corner of a solid cell: by linear extrapolation from inside nodes, its root nodes
// Other nodes have no velocity. So slivers of cells neither move independently nor fray the surface [Badia, Verdugo &
// Martin 2018, The aggregated unfitted finite element method for elliptic problems, Comput. Methods Appl. Mech. Eng.
// 336].
struct NodeRoles {
  std::vector<std::uint8_t> inside;   // for each node: 1 if it is in the solid and has mass, prescribed or not
  std::vector<std::int32_t> support;  // for each node: the support that prescribes its velocity; -1: none
  struct Constrained {
    std::size_t node;
    std::vector<NodeWeight> roots;  // empty if no inside node is near
  };
  std::vector<Constrained> constrained;      // ascending
  std::vector<std::int32_t> constrained_of;  // for each node: its index there; -1: none, or no roots

  bool IsFree(std::size_t node) const { return inside[node] != 0 && support[node] < 0; }
  bool IsPrescribed(std::size_t node) const { return support[node] >= 0; }
  bool HasVelocity(std::size_t node) const {
    return inside[node] != 0 || support[node] >= 0 || constrained_of[node] >= 0;
  }
  // Calls body(node, weight) for the free and prescribed nodes that determine the velocity of a node: itself, or its
  // root nodes.
  template <class Body>
  void ForRoots(std::size_t node, const Body& body) const {
    if (inside[node] != 0 || support[node] >= 0) body(node, 1.0);
    if (constrained_of[node] < 0) return;
    for (const NodeWeight& part : constrained[constrained_of[node]].roots) body(part.node, part.weight);
  }
};

// mass: for each node, an eighth of the mass of the cells around it; 0 if none of them is solid.
void SetNodeRoles(const EulerianBody& body, const EulerianState& state, const EulerianCells& cells,
                  const std::vector<double>& mass, ThreadTeam& team, NodeRoles& roles);

// Sorts parts by their nodes and adds up the parts of each node.
//   add(sum, part)  adds a part to another one of the same node
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

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_NODE_ROLES_H_
