#ifndef FASCICLE_CORE_GEOMETRY_VTK_CELLS_H_
#define FASCICLE_CORE_GEOMETRY_VTK_CELLS_H_

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/geometry/mesh_readers.h"

namespace fascicle {

// The cells of a VTK unstructured grid, whichever format they came in.
struct VtkCells {
  std::vector<std::int64_t> types;         // one each
  std::vector<std::int64_t> ends;          // where each cell's nodes end in `connectivity`
  std::vector<std::int64_t> connectivity;  // node indices
  std::vector<std::int64_t> tags;          // one each, or empty
};

// Whether a cell array of this name holds physical tags: physical, gmsh:physical, medit:ref, tag.
bool IsTagArray(std::string_view name);

// Takes tetrahedra and triangles into `raw`, adding `first_node` to their nodes. Gives what is wrong, or nothing.
std::string AddCells(const VtkCells& cells, std::int64_t node_count, std::int64_t first_node, RawMesh& raw);

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_VTK_CELLS_H_
