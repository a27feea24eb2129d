#include "client/render/body_mesh.h"

#include <vtkCellArray.h>
#include <vtkDataSetSurfaceFilter.h>
#include <vtkDoubleArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyDataNormals.h>
#include <vtkStreamTracer.h>
#include <vtkWindowedSincPolyDataFilter.h>

#include <algorithm>
#include <array>
#include <set>

#include "client/lib/tetrahedra.h"
#include "client/render/field_values.h"
#include "client/vtk/body_grid.h"

namespace fascicle::client {
namespace {

// Each subdivision of a quadratic face cuts its edges in half.
constexpr int kSubdivisions = 2;
constexpr int kEdgeParts = 1 << kSubdivisions;

// Every n-th centroid; the same ones in every frame.
template <class Elements>
vtkSmartPointer<vtkPolyData> MakeSeeds(const Elements& elements, const std::vector<Vec3>& positions, int seeds) {
  const std::size_t stride = std::max<std::size_t>(1, elements.size() / static_cast<std::size_t>(seeds));
  std::vector<Vec3> centroids;
  for (std::size_t e = stride / 2; e < elements.size(); e += stride) {
    Vec3 sum = Vec3::Zero();
    for (const std::uint32_t node : elements[e]) sum += positions[node];
    centroids.emplace_back(sum / static_cast<double>(elements[e].size()));
  }
  auto data = vtkSmartPointer<vtkPolyData>::New();
  data->SetPoints(MakePoints(centroids));
  return data;
}

}  // namespace

vtkSmartPointer<vtkUnstructuredGrid> MakeGrid(const BodyShape& shape, const std::vector<Vec3>& positions,
                                              const std::vector<double>& values) {
  const auto grid = MakeGrid(shape, positions);
  SetColours(values, *grid);
  return grid;
}

void SetColours(const std::vector<double>& values, vtkUnstructuredGrid& grid) {
  if (values.empty()) return;
  vtkNew<vtkDoubleArray> colour;
  colour->SetName("colour");
  colour->SetNumberOfValues(static_cast<vtkIdType>(values.size()));
  std::copy(values.begin(), values.end(), colour->GetPointer(0));
  grid.GetPointData()->SetScalars(colour);
}

vtkSmartPointer<vtkPolyData> MakeCurvedEdges(const BodyShape& shape, const std::vector<Vec3>& positions,
                                             const std::vector<double>& values) {
  // Ends and mid-edge node of each edge.
  std::set<std::array<std::uint32_t, 3>> edges;
  for (const SurfaceTriangle& triangle : SurfaceTriangles(shape)) {
    for (std::size_t c = 0; c < 3; ++c) {
      const auto [i, j] = std::minmax(triangle.corners[c], triangle.corners[(c + 1) % 3]);
      edges.insert({i, j, triangle.middles[c]});
    }
  }
  std::vector<Vec3> points;
  vtkNew<vtkDoubleArray> colour;
  colour->SetName("colour");
  vtkNew<vtkCellArray> lines;
  for (const auto& [i, j, middle] : edges) {
    lines->InsertNextCell(kEdgeParts + 1);
    for (int k = 0; k <= kEdgeParts; ++k) {
      const double a = static_cast<double>(k) / kEdgeParts, b = 1 - a;
      const auto at = [&, i = i, j = j, m = middle](const auto& of) {
        return b * (2 * b - 1) * of[i] + a * (2 * a - 1) * of[j] + 4 * a * b * of[m];
      };
      lines->InsertCellPoint(static_cast<vtkIdType>(points.size()));
      points.emplace_back(at(positions));
      if (!values.empty()) colour->InsertNextValue(at(values));
    }
  }
  auto data = vtkSmartPointer<vtkPolyData>::New();
  data->SetPoints(MakePoints(points));
  data->SetLines(lines);
  if (!values.empty()) data->GetPointData()->SetScalars(colour);
  return data;
}

vtkSmartPointer<vtkUnstructuredGrid> MakeGrid(const RigidShape& body, const Pose& pose) {
  BodyShape shape;
  shape.triangles = body.triangles;
  return MakeGrid(shape, PositionsAt(body, pose));
}

bool IsOfVoxels(const BodyShape& shape) {
  constexpr double kAlike = 1e-6;
  if (shape.bricks.empty()) return false;
  const std::vector<Vec3>& x = shape.positions;
  const auto& first = shape.bricks[0];
  const double size = (x[first[7]] - x[first[0]]).norm();
  return std::all_of(shape.bricks.begin(), shape.bricks.end(), [&](const auto& brick) {
    for (std::size_t c = 1; c < 8; ++c) {
      const Vec3 edge = x[brick[c]] - x[brick[0]], of_first = x[first[c]] - x[first[0]];
      if ((edge - of_first).norm() > kAlike * size) return false;
    }
    return true;
  });
}

vtkSmartPointer<vtkPolyData> MakeSurface(vtkUnstructuredGrid& grid, bool smooth) {
  vtkNew<vtkDataSetSurfaceFilter> surface;
  surface->SetInputData(&grid);
  surface->SetNonlinearSubdivisionLevel(kSubdivisions);
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
  const auto grid = MakeLinearGrid(shape, positions);
  vtkNew<vtkDoubleArray> directions;
  directions->SetName("fibre");
  directions->SetNumberOfComponents(3);
  for (const Vec3& direction : FibresAtNodes(shape, positions)) directions->InsertNextTuple(direction.data());
  grid->GetPointData()->SetVectors(directions);
  vtkNew<vtkStreamTracer> tracer;
  tracer->SetInputData(grid);
  tracer->SetSourceData(shape.bricks.empty() ? MakeSeeds(shape.tetrahedra, positions, seeds)
                                             : MakeSeeds(shape.bricks, positions, seeds));
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
