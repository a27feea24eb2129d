#ifndef FASCICLE_TESTS_SUPPORT_NODES_WHERE_H_
#define FASCICLE_TESTS_SUPPORT_NODES_WHERE_H_

#include <cstdint>
#include <vector>

#include "core/geometry/tet_mesh.h"

namespace fascicle {

// The nodes whose positions satisfy the predicate, ascending.
inline std::vector<std::int32_t> NodesWhere(const TetMesh& mesh, const auto& predicate) {
  std::vector<std::int32_t> nodes;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    if (predicate(mesh.nodes[n])) nodes.push_back(static_cast<std::int32_t>(n));
  }
  return nodes;
}

}  // namespace fascicle

#endif  // FASCICLE_TESTS_SUPPORT_NODES_WHERE_H_
