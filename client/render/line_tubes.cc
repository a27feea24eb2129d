#include "client/render/line_tubes.h"

#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkTubeFilter.h>

namespace fascicle::client {

vtkSmartPointer<vtkPolyData> MakeTube(const std::vector<Vec3>& points, double radius) {
  // Skips points that coincide, because they define no direction.
  vtkNew<vtkPoints> places;
  places->SetDataTypeToDouble();
  const Vec3* last = nullptr;
  for (const Vec3& x : points) {
    if (last != nullptr && (x - *last).norm() < 1e-3 * radius) continue;
    places->InsertNextPoint(x.data());
    last = &x;
  }
  const vtkIdType count = places->GetNumberOfPoints();
  if (count < 2) return vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkCellArray> cells;
  cells->InsertNextCell(count);
  for (vtkIdType i = 0; i < count; ++i) cells->InsertCellPoint(i);
  vtkNew<vtkPolyData> line;
  line->SetPoints(places);
  line->SetLines(cells);
  vtkNew<vtkTubeFilter> tube;
  tube->SetInputData(line);
  tube->SetRadius(radius);
  tube->SetNumberOfSides(16);
  tube->CappingOn();
  tube->Update();
  return tube->GetOutput();
}

}  // namespace fascicle::client
