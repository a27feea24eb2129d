#include "core/geometry/vtk_cells.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace fascicle {
namespace {

// VTK's cell types.
constexpr std::int64_t kTriangle = 5, kQuad = 9, kTetrahedron = 10, kVoxel = 11, kPentagonalPrism = 15,
                       kHexagonalPrism = 16, kQuadraticTriangle = 22, kQuadraticQuad = 23, kQuadraticTetrahedron = 24,
                       kBiquadraticQuad = 28, kPolyhedron = 42, kLagrangeTetrahedron = 71, kLagrangeHexahedron = 72,
                       kLagrangeWedge = 73, kLagrangePyramid = 74;
struct VtkSolid {
  std::int64_t type;
  SolidShape shape;
  std::int64_t nodes;
};
constexpr VtkSolid kVtkSolids[] = {
    {kVoxel, SolidShape::kHexahedron, 8}, {12, SolidShape::kHexahedron, 8},  {13, SolidShape::kWedge, 6},
    {14, SolidShape::kPyramid, 5},        {25, SolidShape::kHexahedron, 20}, {26, SolidShape::kWedge, 15},
    {27, SolidShape::kPyramid, 13},       {29, SolidShape::kHexahedron, 27}, {31, SolidShape::kWedge, 12},
    {32, SolidShape::kWedge, 18},         {33, SolidShape::kHexahedron, 24}};
const VtkSolid* SolidOf(std::int64_t type) {
  for (const VtkSolid& solid : kVtkSolids) {
    if (solid.type == type) return &solid;
  }
  return nullptr;
}

bool IsOtherSolid(std::int64_t type) {
  return type == kPentagonalPrism || type == kHexagonalPrism || type == kPolyhedron || type == kLagrangeHexahedron ||
         type == kLagrangeWedge || type == kLagrangePyramid;
}

// Number of nodes of the linear cell types 0 to 14; 0 where it may vary.
constexpr std::int64_t kNodes[] = {0, 1, 0, 2, 0, 3, 0, 0, 4, 4, 4, 8, 8, 6, 5};
std::int64_t NodesOf(std::int64_t type) {
  if (const VtkSolid* solid = SolidOf(type)) return solid->nodes;
  if (type == kQuadraticTriangle) return 6;
  if (type == kQuadraticQuad) return 8;
  if (type == kBiquadraticQuad) return 9;
  if (type == kQuadraticTetrahedron) return 10;
  return type >= 0 && type < std::ssize(kNodes) ? kNodes[type] : 0;
}

bool IsTriangle(std::int64_t type) { return type == kTriangle || type == kQuadraticTriangle; }
bool IsQuad(std::int64_t type) { return type == kQuad || type == kQuadraticQuad || type == kBiquadraticQuad; }
bool IsTetrahedron(std::int64_t type) { return type == kTetrahedron || type == kQuadraticTetrahedron; }

void AddSolid(const VtkSolid& type, const std::int64_t* nodes, std::int64_t first_node, std::int64_t tag,
              RawMesh& raw) {
  RawSolid solid{type.shape, {}};
  const int corners = CornersOf(type.shape);
  for (int n = 0; n < corners; ++n) solid.nodes[n] = nodes[n] + first_node;
  if (type.type == kVoxel) {  // numbered along the axes
    std::swap(solid.nodes[2], solid.nodes[3]);
    std::swap(solid.nodes[6], solid.nodes[7]);
  }
  if (type.nodes > corners) ++raw.curved_solids;
  if (type.shape == SolidShape::kHexahedron && type.nodes >= 20) {
    solid.middles.emplace();
    for (std::size_t k = 0; k < 12; ++k) (*solid.middles)[k] = nodes[8 + k] + first_node;
    raw.inner_nodes += static_cast<std::size_t>(type.nodes) - 20;
  }
  raw.solids.push_back(solid);
  raw.solid_tags.push_back(tag);
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
    const VtkSolid* solid = SolidOf(type);
    if (solid == nullptr && !IsTetrahedron(type) && !IsTriangle(type) && !IsQuad(type)) {
      ++(type == kLagrangeTetrahedron ? raw.higher_order : IsOtherSolid(type) ? raw.other_solids : raw.others);
      continue;
    }
    const auto outside = std::find_if(nodes, nodes + size, [&](std::int64_t n) { return n < 0 || n >= node_count; });
    if (outside != nodes + size) {
      return name() + " refers to node " + std::to_string(*outside) + " of " + std::to_string(node_count) +
             " (counted from 0)";
    }
    const std::int64_t tag = cells.tags.empty() ? 0 : cells.tags[c];
    if (solid != nullptr) {
      AddSolid(*solid, nodes, first_node, tag, raw);
    } else if (IsTetrahedron(type)) {
      AddCell(nodes, first_node, raw.tetrahedra);
      if (type == kQuadraticTetrahedron) AddCell(nodes + 4, first_node, raw.middles);
      raw.tetrahedron_tags.push_back(tag);
    } else if (IsQuad(type)) {
      AddCell(nodes, first_node, raw.quads);
      raw.quad_tags.push_back(tag);
    } else {
      AddCell(nodes, first_node, raw.triangles);
      raw.triangle_tags.push_back(tag);
    }
  }
  return {};
}

}  // namespace fascicle
