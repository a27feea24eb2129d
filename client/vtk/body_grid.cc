#include "client/vtk/body_grid.h"

#include <vtkCellType.h>
#include <vtkNew.h>
#include <vtkUnsignedCharArray.h>

#include "core/geometry/solid_cells.h"

namespace fascicle::client {
namespace {

template <std::size_t kNodes, class Element>
std::array<vtkIdType, kNodes> NodesOf(const Element& element, const std::array<std::size_t, kNodes>& order) {
  std::array<vtkIdType, kNodes> nodes;
  for (std::size_t c = 0; c < kNodes; ++c) nodes[c] = element[order[c]];
  return nodes;
}

// All elements must be of one kind; `order` lists their corners in VTK's order.
template <std::size_t kNodes, class Elements>
vtkSmartPointer<vtkCellArray> MakeCells(const Elements& elements, const std::array<std::size_t, kNodes>& order) {
  auto cells = vtkSmartPointer<vtkCellArray>::New();
  const auto count = static_cast<vtkIdType>(elements.size());
  cells->AllocateExact(count, static_cast<vtkIdType>(kNodes) * count);
  for (const auto& element : elements) cells->InsertNextCell(kNodes, NodesOf(element, order).data());
  return cells;
}

// kTetEdges is VTK's order of mid-edge nodes.
vtkSmartPointer<vtkCellArray> MakeQuadraticCells(const BodyShape& shape) {
  auto cells = vtkSmartPointer<vtkCellArray>::New();
  const auto count = static_cast<vtkIdType>(shape.tetrahedra.size());
  cells->AllocateExact(count, 10 * count);
  for (std::size_t t = 0; t < shape.tetrahedra.size(); ++t) {
    const std::array<std::uint32_t, 10> nodes = shape.TenNodes(t);
    const std::array<vtkIdType, 10> ids = {nodes[0], nodes[1], nodes[2], nodes[3], nodes[4],
                                           nodes[5], nodes[6], nodes[7], nodes[8], nodes[9]};
    cells->InsertNextCell(10, ids.data());
  }
  return cells;
}

// Bricks with repeated nodes are wedges and pyramids. VTK sees the base of a wedge from outside.
void SetBricks(const std::vector<std::array<std::uint32_t, 8>>& bricks, vtkUnstructuredGrid& grid) {
  constexpr std::array<std::size_t, 6> kWedge = {0, 2, 1, 3, 5, 4};
  vtkNew<vtkCellArray> cells;
  vtkNew<vtkUnsignedCharArray> types;
  cells->AllocateEstimate(static_cast<vtkIdType>(bricks.size()), 8);
  types->Allocate(static_cast<vtkIdType>(bricks.size()));
  for (const std::array<std::uint32_t, 8>& brick : bricks) {
    std::array<std::uint32_t, 8> hexahedron;
    for (std::size_t c = 0; c < 8; ++c) hexahedron[c] = brick[kHexahedronCorners[c]];
    const auto solid = SolidOf(hexahedron);
    std::vector<vtkIdType> nodes(hexahedron.begin(), hexahedron.end());
    int type = VTK_HEXAHEDRON;
    if (solid && solid->shape == SolidShape::kWedge) {
      type = VTK_WEDGE;
      nodes.resize(6);
      for (std::size_t c = 0; c < 6; ++c) nodes[c] = solid->nodes[kWedge[c]];
    } else if (solid && solid->shape == SolidShape::kPyramid) {
      type = VTK_PYRAMID;
      nodes.resize(5);
    }
    cells->InsertNextCell(static_cast<vtkIdType>(nodes.size()), nodes.data());
    types->InsertNextValue(static_cast<unsigned char>(type));
  }
  grid.SetCells(types, cells);
}

}  // namespace

vtkSmartPointer<vtkPoints> MakePoints(const std::vector<Vec3>& positions) {
  auto points = vtkSmartPointer<vtkPoints>::New();
  points->SetDataTypeToDouble();
  points->SetNumberOfPoints(static_cast<vtkIdType>(positions.size()));
  for (std::size_t i = 0; i < positions.size(); ++i) points->SetPoint(static_cast<vtkIdType>(i), positions[i].data());
  return points;
}

vtkSmartPointer<vtkCellArray> MakeTriangles(const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  return MakeCells(triangles, std::array<std::size_t, 3>{0, 1, 2});
}

vtkSmartPointer<vtkUnstructuredGrid> MakeGrid(const BodyShape& shape, const std::vector<Vec3>& positions) {
  auto grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
  grid->SetPoints(MakePoints(positions));
  if (!shape.bricks.empty()) {
    SetBricks(shape.bricks, *grid);
  } else if (!shape.triangles.empty()) {
    grid->SetCells(VTK_TRIANGLE, MakeTriangles(shape.triangles));
  } else if (shape.quadratic()) {
    grid->SetCells(VTK_QUADRATIC_TETRA, MakeQuadraticCells(shape));
  } else {
    grid->SetCells(VTK_TETRA, MakeCells(shape.tetrahedra, std::array<std::size_t, 4>{0, 1, 2, 3}));
  }
  return grid;
}

vtkSmartPointer<vtkUnstructuredGrid> MakeLinearGrid(const BodyShape& shape, const std::vector<Vec3>& positions) {
  if (!shape.quadratic()) return MakeGrid(shape, positions);
  // The corners are cut off; the octahedron between is divided around the diagonal from node 6 to node 8.
  constexpr std::array<std::array<std::size_t, 4>, 8> kParts = {
      {{0, 4, 6, 7}, {4, 1, 5, 8}, {6, 5, 2, 9}, {7, 8, 9, 3}, {6, 8, 4, 5}, {6, 8, 5, 9}, {6, 8, 9, 7}, {6, 8, 7, 4}}};
  BodyShape divided;
  divided.tetrahedra.reserve(8 * shape.tetrahedra.size());
  for (std::size_t t = 0; t < shape.tetrahedra.size(); ++t) {
    const std::array<std::uint32_t, 10> nodes = shape.TenNodes(t);
    for (const auto& part : kParts) {
      divided.tetrahedra.push_back({nodes[part[0]], nodes[part[1]], nodes[part[2]], nodes[part[3]]});
    }
  }
  return MakeGrid(divided, positions);
}

}  // namespace fascicle::client
