#ifndef FASCICLE_CORE_GEOMETRY_UNUSED_NODES_H_
#define FASCICLE_CORE_GEOMETRY_UNUSED_NODES_H_

#include <cstdint>
#include <vector>

#include "core/base/types.h"

namespace fascicle {

// Removes nodes that no cell (triangle, tetrahedron) refers to and renumbers the others, preserving their order.
template <class Cell>
void DropUnusedNodes(std::vector<Vec3>& nodes, std::vector<Cell>& cells) {
  std::vector<std::int32_t> number(nodes.size(), -1);
  for (const Cell& cell : cells) {
    for (const std::int32_t n : cell) number[n] = 0;
  }
  std::int32_t count = 0;
  for (std::size_t n = 0; n < number.size(); ++n) {
    if (number[n] < 0) continue;
    nodes[count] = nodes[n];
    number[n] = count++;
  }
  nodes.resize(count);
  for (Cell& cell : cells) {
    for (std::int32_t& n : cell) n = number[n];
  }
}

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_UNUSED_NODES_H_
