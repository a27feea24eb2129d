#include "client/render/body_mesh.h"

#include <vtkDataSetSurfaceFilter.h>
#include <vtkDoubleArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyDataNormals.h>
#include <vtkStreamTracer.h>
#include <vtkWindowedSincPolyDataFilter.h>

#include <algorithm>

#include "client/render/field_values.h"
#include "client/vtk/body_grid.h"

namespace fascicle::client {
namespace {

// Every n-th centroid; the same ones in every frame.
vtkSmartPointer<vtkPolyData> MakeSeeds(const BodyShape& shape, const std::vector<Vec3>& positions, int seeds) {
  const std::size_t count = shape.tetrahedra.size();
  const std::size_t stride = std::max<std::size_t>(1, count / static_cast<std::size_t>(seeds));
  std::vector<Vec3> centroids;
  for (std::size_t e = stride / 2; e < count; e += stride) {
    const auto& t = shape.tetrahedra[e];
    centroids.push_back((positions[t[0]] + positions[t[1]] + positions[t[2]] + positions[t[3]]) / 4);
  }
  auto data = vtkSmartPointer<vtkPolyData>::New();
  data->SetPoints(MakePoints(centroids));
  return data;
}

}  // namespace

vtkSmartPointer<vtkUnstructuredGrid> MakeGrid(const BodyShape& shape, const std::vector<Vec3>& positions,
                                              const std::vector<double>& values) {
  const auto grid = MakeGrid(shape, positions);
  if (!values.empty()) {
    vtkNew<vtkDoubleArray> colour;
    colour->SetName("colour");
    colour->SetNumberOfValues(static_cast<vtkIdType>(values.size()));
    std::copy(values.begin(), values.end(), colour->GetPointer(0));
    grid->GetPointData()->SetScalars(colour);
  }
  return grid;
}

vtkSmartPointer<vtkUnstructuredGrid> MakeGrid(const RigidShape& body, const Pose& pose) {
  BodyShape shape;
  shape.triangles = body.triangles;
  return MakeGrid(shape, PositionsAt(body, pose));
}

vtkSmartPointer<vtkPolyData> MakeSurface(vtkUnstructuredGrid& grid, bool smooth) {
  vtkNew<vtkDataSetSurfaceFilter> surface;
  surface->SetInputData(&grid);
  // Taubin's filter, which does not shrink.
  vtkNew<vtkWindowedSincPolyDataFilter> sinc;
  sinc->SetInputConnection(surface->GetOutputPort());
  sinc->SetNumberOfIterations(20);
  sinc->SetPassBand(0.05);
  sinc->BoundarySmoothingOff();
  sinc->FeatureEdgeSmoothingOff();
  sinc->NormalizeCoordinatesOn();
  vtkNew<vtkPolyDataNormals> normals;
  normals->SetInputConnection(smooth ? sinc->GetOutputPort() : surface->GetOutputPort());
  normals->SetFeatureAngle(smooth ? 60 : 40);
  normals->SplittingOn();
  normals->Update();
  return normals->GetOutput();
}

vtkSmartPointer<vtkPolyData> MakeFibreLines(const BodyShape& shape, const std::vector<Vec3>& positions, int seeds) {
  if (shape.fibres.empty()) return vtkSmartPointer<vtkPolyData>::New();
  const auto grid = MakeGrid(shape, positions);
  vtkNew<vtkDoubleArray> directions;
  directions->SetName("fibre");
  directions->SetNumberOfComponents(3);
  for (const Vec3& direction : FibresAtNodes(shape, positions)) directions->InsertNextTuple(direction.data());
  grid->GetPointData()->SetVectors(directions);
  vtkNew<vtkStreamTracer> tracer;
  tracer->SetInputData(grid);
  tracer->SetSourceData(MakeSeeds(shape, positions, seeds));
  tracer->SetIntegratorTypeToRungeKutta4();
  tracer->SetIntegrationDirectionToBoth();
  tracer->SetIntegrationStepUnit(vtkStreamTracer::CELL_LENGTH_UNIT);
  tracer->SetInitialIntegrationStep(0.3);
  tracer->SetMaximumPropagation(grid->GetLength());
  tracer->SetMaximumNumberOfSteps(1000);
  tracer->SetComputeVorticity(false);
  tracer->Update();
  return tracer->GetOutput();
}

}  // namespace fascicle::client
