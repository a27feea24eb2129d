#include "client/render/line_tubes.h"

#include <vtkAppendPolyData.h>
#include <vtkLineSource.h>
#include <vtkNew.h>
#include <vtkSphereSource.h>
#include <vtkTubeFilter.h>

namespace fascicle::client {
namespace {

constexpr int kSides = 16;

void AddCylinder(const Vec3& a, const Vec3& b, double radius, vtkAppendPolyData& parts) {
  vtkNew<vtkLineSource> line;
  line->SetPoint1(a.x(), a.y(), a.z());
  line->SetPoint2(b.x(), b.y(), b.z());
  line->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
  vtkNew<vtkTubeFilter> tube;
  tube->SetInputConnection(line->GetOutputPort());
  tube->SetRadius(radius);
  tube->SetNumberOfSides(kSides);
  tube->CappingOn();
  tube->Update();
  parts.AddInputData(tube->GetOutput());
}

void AddSphere(const Vec3& centre, double radius, vtkAppendPolyData& parts) {
  vtkNew<vtkSphereSource> sphere;
  sphere->SetCenter(centre.x(), centre.y(), centre.z());
  sphere->SetRadius(radius);
  sphere->SetThetaResolution(kSides);
  sphere->SetPhiResolution(kSides);
  sphere->Update();
  parts.AddInputData(sphere->GetOutput());
}

}  // namespace

vtkSmartPointer<vtkPolyData> MakeTube(const std::vector<Vec3>& points, double radius) {
  vtkNew<vtkAppendPolyData> parts;
  const Vec3* last = nullptr;
  for (const Vec3& x : points) {
    // Points that coincide define no direction.
    if (last != nullptr && (x - *last).norm() < 1e-3 * radius) continue;
    if (last != nullptr) {
      if (parts->GetNumberOfInputConnections(0) > 0) AddSphere(*last, radius, *parts);
      AddCylinder(*last, x, radius, *parts);
    }
    last = &x;
  }
  if (parts->GetNumberOfInputConnections(0) == 0) return vtkSmartPointer<vtkPolyData>::New();
  parts->Update();
  return parts->GetOutput();
}

}  // namespace fascicle::client
