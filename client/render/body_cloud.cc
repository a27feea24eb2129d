#include "client/render/body_cloud.h"

#include <vtkActor.h>
#include <vtkColorTransferFunction.h>
#include <vtkDataArray.h>
#include <vtkFixedPointVolumeRayCastMapper.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkImageGaussianSmooth.h>
#include <vtkNew.h>
#include <vtkPiecewiseFunction.h>
#include <vtkPointData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkResampleToImage.h>
#include <vtkUnsignedShortArray.h>
#include <vtkVolume.h>
#include <vtkVolumeProperty.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace fascicle::client {
namespace {

constexpr int kSamples = 200;         // along the longest side
constexpr double kFull = 65535;       // maximum of the numbers that rays accumulate
constexpr double kDepthOfHaze = 0.4;  // of the shortest side: where 63 % of the light is absorbed

struct Samples {
  vtkSmartPointer<vtkImageData> image;  // of two components: value on the colour scale, and density
  double step = 0;                      // spacing [m]
};

// One extra sample on each side of the body, so that its surface is closed.
Samples Resample(vtkUnstructuredGrid& grid, const ColourScale& scale) {
  std::array<double, 6> bounds;
  grid.GetBounds(bounds.data());
  double longest = 0;
  for (int d = 0; d < 3; ++d) longest = std::max(longest, bounds[2 * d + 1] - bounds[2 * d]);
  const double step = longest / kSamples;
  std::array<int, 3> dimensions;
  for (int d = 0; d < 3; ++d) {
    dimensions[d] = static_cast<int>(std::ceil((bounds[2 * d + 1] - bounds[2 * d]) / step)) + 5;
    const double middle = (bounds[2 * d] + bounds[2 * d + 1]) / 2, half = step * (dimensions[d] - 1) / 2;
    bounds[2 * d] = middle - half;
    bounds[2 * d + 1] = middle + half;
  }
  vtkNew<vtkResampleToImage> resample;
  resample->SetInputDataObject(&grid);
  resample->UseInputBoundsOff();
  resample->SetSamplingBounds(bounds.data());
  resample->SetSamplingDimensions(dimensions.data());
  resample->Update();
  vtkPointData& points = *resample->GetOutput()->GetPointData();
  vtkDataArray* inside = points.GetArray("vtkValidPointMask");
  vtkDataArray* colour = points.GetArray("colour");
  Samples samples;
  samples.step = step;
  samples.image = vtkSmartPointer<vtkImageData>::New();
  samples.image->CopyStructure(resample->GetOutput());
  vtkNew<vtkUnsignedShortArray> values;
  values->SetName("samples");
  values->SetNumberOfComponents(2);
  values->SetNumberOfTuples(inside->GetNumberOfTuples());
  for (vtkIdType i = 0; i < inside->GetNumberOfTuples(); ++i) {
    const double value = colour == nullptr ? 0 : colour->GetTuple1(i);
    const double part = std::clamp((value - scale.lowest) / (scale.highest - scale.lowest), 0.0, 1.0);
    values->SetTypedComponent(i, 0, static_cast<unsigned short>(kFull * (std::isfinite(part) ? part : 0)));
    values->SetTypedComponent(i, 1, inside->GetTuple1(i) > 0 ? static_cast<unsigned short>(kFull) : 0);
  }
  samples.image->GetPointData()->SetScalars(values);
  return samples;
}

void AddHaze(const Samples& samples, const ColourScale& scale, vtkRenderer& renderer) {
  std::array<double, 6> bounds;
  samples.image->GetBounds(bounds.data());
  double shortest = bounds[1] - bounds[0];
  for (int d = 1; d < 3; ++d) shortest = std::min(shortest, bounds[2 * d + 1] - bounds[2 * d]);
  vtkNew<vtkColorTransferFunction> colours;
  if (scale.table == nullptr) {
    colours->AddRGBPoint(0, 0.78, 0.36, 0.32);
  } else {
    const vtkIdType count = scale.table->GetNumberOfTableValues();
    for (vtkIdType i = 0; i < count; ++i) {
      const double* rgba = scale.table->GetTableValue(i);
      colours->AddRGBPoint(kFull * static_cast<double>(i) / static_cast<double>(std::max<vtkIdType>(1, count - 1)),
                           rgba[0], rgba[1], rgba[2]);
    }
  }
  vtkNew<vtkPiecewiseFunction> opacity;
  opacity->AddPoint(0, 0);
  opacity->AddPoint(kFull, 1 - std::exp(-1.0));
  vtkNew<vtkVolumeProperty> property;
  property->IndependentComponentsOff();
  property->SetColor(0, colours);
  property->SetScalarOpacity(0, opacity);
  property->SetScalarOpacityUnitDistance(0, kDepthOfHaze * shortest);
  property->SetInterpolationTypeToLinear();
  property->ShadeOff();
  vtkNew<vtkFixedPointVolumeRayCastMapper> mapper;
  mapper->SetInputData(samples.image);
  mapper->AutoAdjustSampleDistancesOff();
  mapper->SetSampleDistance(static_cast<float>(samples.step));
  mapper->SetImageSampleDistance(2);  // in pixels before downsampling
  mapper->SetNumberOfThreads(1);
  vtkNew<vtkVolume> volume;
  volume->SetMapper(mapper);
  volume->SetProperty(property);
  renderer.AddVolume(volume);
}

void AddVeil(const Samples& samples, vtkRenderer& renderer) {
  vtkNew<vtkImageData> density;
  density->CopyStructure(samples.image);
  density->AllocateScalars(VTK_FLOAT, 1);
  vtkDataArray& from = *samples.image->GetPointData()->GetScalars();
  for (vtkIdType i = 0; i < from.GetNumberOfTuples(); ++i) {
    density->GetPointData()->GetScalars()->SetTuple1(i, from.GetComponent(i, 1) / kFull);
  }
  vtkNew<vtkImageGaussianSmooth> blur;  // smooths the steps between samples
  blur->SetInputData(density);
  blur->SetStandardDeviations(1, 1, 1);
  vtkNew<vtkFlyingEdges3D> surface;
  surface->SetInputConnection(blur->GetOutputPort());
  surface->SetValue(0, 0.5);
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputConnection(surface->GetOutputPort());
  mapper->ScalarVisibilityOff();
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  vtkProperty& property = *actor->GetProperty();
  property.SetColor(0.93, 0.93, 0.96);
  property.SetOpacity(0.22);
  property.SetSpecular(0.5);
  property.SetSpecularPower(30);
  renderer.AddActor(actor);
}

}  // namespace

void AddCloud(vtkUnstructuredGrid& grid, const ColourScale& scale, vtkRenderer& renderer) {
  const Samples samples = Resample(grid, scale);
  AddHaze(samples, scale, renderer);
  AddVeil(samples, renderer);
}

}  // namespace fascicle::client
