#include "client/vtk/body_grid.h"

#include <vtkCellType.h>
#include <vtkNew.h>

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
    grid->SetCells(VTK_HEXAHEDRON, MakeCells(shape.bricks, kHexahedronCorners));
  } else if (!shape.triangles.empty()) {
    grid->SetCells(VTK_TRIANGLE, MakeTriangles(shape.triangles));
  } else {
    grid->SetCells(VTK_TETRA, MakeCells(shape.tetrahedra, std::array<std::size_t, 4>{0, 1, 2, 3}));
  }
  return grid;
}

}  // namespace fascicle::client
