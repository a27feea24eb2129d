#ifndef FASCICLE_CORE_GEOMETRY_VTK_CELLS_H_
#define FASCICLE_CORE_GEOMETRY_VTK_CELLS_H_

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/geometry/mesh_readers.h"

namespace fascicle {

// The cells of a VTK unstructured grid, in any of its formats.
struct VtkCells {
  std::vector<std::int64_t> types;         // one for each cell
  std::vector<std::int64_t> ends;          // where the nodes of each cell end in `connectivity`
  std::vector<std::int64_t> connectivity;  // node indices
  std::vector<std::int64_t> tags;          // one for each cell, or empty
};

// Whether a cell array of this name holds physical tags: physical, gmsh:physical, medit:ref, tag.
bool IsTagArray(std::string_view name);

// Adds volume and surface cells to `raw`, with `first_node` added to their nodes. Returns what is wrong, or an empty
// string.
std::string AddCells(const VtkCells& cells, std::int64_t node_count, std::int64_t first_node, RawMesh& raw);

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_VTK_CELLS_H_
