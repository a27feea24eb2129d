#include "core/geometry/vtk_cells.h"

#include <algorithm>
#include <iterator>

namespace fascicle {
namespace {

// VTK's cell types.
constexpr std::int64_t kTriangle = 5, kTetrahedron = 10, kQuadraticTriangle = 22, kQuadraticTetrahedron = 24,
                       kLagrangeTetrahedron = 71;

// Number of nodes of the linear cell types 0 to 14; 0 where it may vary.
constexpr std::int64_t kNodes[] = {0, 1, 0, 2, 0, 3, 0, 0, 4, 4, 4, 8, 8, 6, 5};
std::int64_t NodesOf(std::int64_t type) {
  if (type == kQuadraticTriangle) return 6;
  if (type == kQuadraticTetrahedron) return 10;
  return type >= 0 && type < std::ssize(kNodes) ? kNodes[type] : 0;
}

template <std::size_t N>
void AddCell(const std::int64_t* nodes, std::int64_t first_node, std::vector<std::array<std::int64_t, N>>& cells) {
  auto& cell = cells.emplace_back();
  for (std::size_t i = 0; i < N; ++i) cell[i] = nodes[i] + first_node;
}

}  // namespace

bool IsTagArray(std::string_view name) {
  return name == "physical" || name == "gmsh:physical" || name == "medit:ref" || name == "tag";
}

std::string AddCells(const VtkCells& cells, std::int64_t node_count, std::int64_t first_node, RawMesh& raw) {
  const std::size_t count = cells.types.size();
  if (cells.ends.size() != count) {
    return std::to_string(count) + " cell types but " + std::to_string(cells.ends.size()) + " cells";
  }
  if (!cells.tags.empty() && cells.tags.size() != count) {
    return std::to_string(cells.tags.size()) + " tags for " + std::to_string(count) + " cells";
  }
  std::int64_t begin = 0;
  for (std::size_t c = 0; c < count; ++c) {
    const auto name = [c] { return "cell " + std::to_string(c); };
    const std::int64_t end = cells.ends[c];
    if (end < begin || end > static_cast<std::int64_t>(cells.connectivity.size())) {
      return name() + " refers beyond the connectivity array";
    }
    const std::int64_t* nodes = cells.connectivity.data() + begin;
    const std::int64_t size = end - begin;
    begin = end;
    const std::int64_t type = cells.types[c];
    if (NodesOf(type) != 0 && size != NodesOf(type)) {
      return name() + " of type " + std::to_string(type) + " has " + std::to_string(size) + " nodes";
    }
    const bool is_tetrahedron = type == kTetrahedron || type == kQuadraticTetrahedron;
    if (!is_tetrahedron && type != kTriangle && type != kQuadraticTriangle) {
      ++(type == kLagrangeTetrahedron ? raw.higher_order : raw.others);
      continue;
    }
    const auto outside = std::find_if(nodes, nodes + size, [&](std::int64_t n) { return n < 0 || n >= node_count; });
    if (outside != nodes + size) {
      return name() + " refers to node " + std::to_string(*outside) + " of " + std::to_string(node_count) +
             " (counted from 0)";
    }
    const std::int64_t tag = cells.tags.empty() ? 0 : cells.tags[c];
    if (is_tetrahedron) {
      AddCell(nodes, first_node, raw.tetrahedra);
      if (type == kQuadraticTetrahedron) AddCell(nodes + 4, first_node, raw.middles);
      raw.tetrahedron_tags.push_back(tag);
    } else {
      AddCell(nodes, first_node, raw.triangles);
      raw.triangle_tags.push_back(tag);
    }
  }
  return {};
}

}  // namespace fascicle
