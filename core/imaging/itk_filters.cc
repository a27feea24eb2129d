#include "core/imaging/itk_filters.h"

#include <itkCurvatureAnisotropicDiffusionImageFilter.h>
#include <itkDiscreteGaussianImageFilter.h>
#include <itkImage.h>

#include <algorithm>
#include <cmath>

#include "core/imaging/itk_import.h"
#include "core/imaging/itk_stop.h"

namespace fascicle {
namespace {

using FloatImage = itk::Image<float, 3>;

template <class Filter>
std::vector<float> ValuesOf(Filter& filter, std::size_t count, const std::stop_token& stop) {
  UpdateUnlessStopped(filter, stop);
  const float* values = filter.GetOutput()->GetBufferPointer();
  return {values, values + count};
}

VolumeImage WithValues(const VolumeImage& image, std::vector<float> values) {
  VolumeImage result;
  result.size = image.size;
  result.spacing = image.spacing;
  result.origin = image.origin;
  result.direction = image.direction;
  result.values = std::move(values);
  return result;
}

}  // namespace

VolumeImage GaussianOf(const VolumeImage& image, const GaussianFilter& filter, const ThreadTeam& team) {
  const auto import = Import(image.values, image.size, image.spacing);
  auto blur = itk::DiscreteGaussianImageFilter<FloatImage, FloatImage>::New();
  blur->SetInput(import->GetOutput());
  blur->SetVariance(filter.deviation * filter.deviation);
  blur->SetUseImageSpacing(true);
  constexpr double kLeftOut = 1e-4;  // relative weight of the kernel's truncated part
  blur->SetMaximumError(kLeftOut);
  const double widest = filter.deviation / image.spacing.minCoeff();
  blur->SetMaximumKernelWidth(2 * static_cast<int>(std::ceil(6 * widest)) + 3);
  blur->SetNumberOfWorkUnits(team.size());
  return WithValues(image, ValuesOf(*blur, image.voxels(), team.stop()));
}

VolumeImage DiffusedOf(const VolumeImage& image, const CurvatureFilter& filter, const ThreadTeam& team) {
  // In units of the smallest spacing, for which the step below is the largest stable one: 1 / 2^4 in three dimensions.
  const auto import = Import(image.values, image.size, image.spacing / image.spacing.minCoeff());
  auto diffusion = itk::CurvatureAnisotropicDiffusionImageFilter<FloatImage, FloatImage>::New();
  diffusion->SetInput(import->GetOutput());
  diffusion->SetNumberOfIterations(filter.iterations);
  diffusion->SetConductanceParameter(filter.conductance);
  diffusion->SetTimeStep(0.0625);
  diffusion->SetUseImageSpacing(true);
  diffusion->SetNumberOfWorkUnits(team.size());
  return WithValues(image, ValuesOf(*diffusion, image.voxels(), team.stop()));
}

}  // namespace fascicle
