#include "core/imaging/bias_field.h"

#include <itkBSplineControlPointImageFilter.h>
#include <itkBinShrinkImageFilter.h>
#include <itkN4BiasFieldCorrectionImageFilter.h>

#include <algorithm>
#include <cmath>
#include <mutex>

#include "core/imaging/classes.h"
#include "core/imaging/itk_import.h"
#include "core/imaging/itk_stop.h"

namespace fascicle {
namespace {

using FloatImage = itk::Image<float, 3>;
using MaskImage = itk::Image<std::uint8_t, 3>;
using N4 = itk::N4BiasFieldCorrectionImageFilter<FloatImage, MaskImage, FloatImage>;
using Lattice = N4::BiasFieldControlPointLatticeType;

// The field is smooth, so it is fitted to block averages, as the authors of N4 do it: about this many voxels along each
// axis of a block, and at least kLeastBlocks blocks.
constexpr double kBlock = 4;
constexpr int kLeastBlocks = 12;
constexpr int kBins = 1024;
constexpr unsigned kSplineOrder = 3;
constexpr std::int32_t kLeastVoxels = 4;  // along each axis, for a spline

// The sums by which N4 fits its splines depend on ITK's default number of threads: sets it to a constant.
void FixDefaultThreads() {
  static std::once_flag once;
  std::call_once(once, [] { itk::MultiThreaderBase::SetGlobalDefaultNumberOfThreads(4); });
}

FloatImage::Pointer Blocks(const VolumeImage& image, FloatImage* whole, const std::stop_token& stop) {
  auto shrink = itk::BinShrinkImageFilter<FloatImage, FloatImage>::New();
  shrink->SetInput(whole);
  for (unsigned axis = 0; axis < 3; ++axis) {
    const double wanted = std::round(kBlock * image.spacing.minCoeff() / image.spacing[axis]);
    const int most = std::max(1, image.size[axis] / kLeastBlocks);
    shrink->SetShrinkFactor(axis, static_cast<unsigned>(std::clamp(wanted, 1.0, static_cast<double>(most))));
  }
  UpdateUnlessStopped(*shrink, stop);
  return shrink->GetOutput();
}

std::size_t VoxelsOf(const FloatImage& image) { return image.GetBufferedRegion().GetNumberOfPixels(); }

// The foreground: everything above 0 except for the darkest of three classes. Null if there is none.
MaskImage::Pointer Foreground(FloatImage& image) {
  const float* const values = image.GetBufferPointer();
  std::vector<float> above_zero;
  std::copy_if(values, values + VoxelsOf(image), std::back_inserter(above_zero), [](float v) { return v > 0; });
  if (above_zero.empty()) return nullptr;
  const Histogram histogram = MakeHistogram(above_zero, kBins);
  if (histogram.filled() < 3) return nullptr;
  const double threshold = OtsuThresholds(histogram, 3)[0];
  auto mask = MaskImage::New();
  mask->CopyInformation(&image);
  mask->SetRegions(image.GetBufferedRegion());
  mask->Allocate();
  std::transform(values, values + VoxelsOf(image), mask->GetBufferPointer(),
                 [threshold](float v) { return v > 0 && v > threshold ? 1 : 0; });
  return mask;
}

Lattice::Pointer FieldOf(FloatImage* blocks, MaskImage* mask, const BiasFieldFilter& settings,
                         const std::stop_token& stop) {
  const unsigned levels = static_cast<unsigned>(settings.refinements) + 1;
  auto n4 = N4::New();
  n4->SetInput(blocks);
  n4->SetMaskImage(mask);
  n4->SetSplineOrder(kSplineOrder);
  n4->SetNumberOfControlPoints(kSplineOrder + 1);  // one cell
  n4->SetNumberOfFittingLevels(levels);
  N4::VariableSizeArrayType iterations(levels);
  iterations.Fill(static_cast<unsigned>(settings.iterations));
  n4->SetMaximumNumberOfIterations(iterations);
  UpdateUnlessStopped(*n4, stop);
  return const_cast<Lattice*>(n4->GetLogBiasFieldControlPointLattice());
}

// The logarithm of the field at the voxels of `image`.
FloatImage::Pointer Reconstruct(Lattice* lattice, const FloatImage& image, const std::stop_token& stop) {
  using Spline = itk::BSplineControlPointImageFilter<Lattice, N4::ScalarImageType>;
  auto spline = Spline::New();
  spline->SetInput(lattice);
  spline->SetOrigin(image.GetOrigin());
  spline->SetSpacing(image.GetSpacing());
  spline->SetDirection(image.GetDirection());
  spline->SetSize(image.GetLargestPossibleRegion().GetSize());
  spline->SetSplineOrder(kSplineOrder);
  UpdateUnlessStopped(*spline, stop);
  auto field = FloatImage::New();
  field->SetRegions(image.GetLargestPossibleRegion());
  field->Allocate();
  const auto* const from = spline->GetOutput()->GetBufferPointer();
  std::transform(from, from + VoxelsOf(*field), field->GetBufferPointer(), [](const auto& value) { return value[0]; });
  return field;
}

double MeanInMask(const FloatImage& field, const MaskImage& mask) {
  double sum = 0, count = 0;
  for (std::size_t v = 0; v < VoxelsOf(field); ++v) {
    if (mask.GetBufferPointer()[v] == 0) continue;
    sum += static_cast<double>(field.GetBufferPointer()[v]);
    ++count;
  }
  return sum / count;
}

// Extends an image that is thinner than `size` by copies of its last layer, or crops a thicker one to its first layers.
VolumeImage WithSize(const VolumeImage& image, const GridIndex& size) {
  VolumeImage result = image;
  result.size = size;
  result.values.clear();
  for (std::int32_t k = 0; k < size[2]; ++k) {
    for (std::int32_t j = 0; j < size[1]; ++j) {
      for (std::int32_t i = 0; i < size[0]; ++i) {
        const GridIndex from = {std::min(i, image.size[0] - 1), std::min(j, image.size[1] - 1),
                                std::min(k, image.size[2] - 1)};
        result.values.push_back(image.values[image.IndexOf(from)]);
      }
    }
  }
  return result;
}

}  // namespace

VolumeImage WithoutBiasField(const VolumeImage& image, const BiasFieldFilter& filter, const std::stop_token& stop) {
  FixDefaultThreads();
  GridIndex thick = image.size;
  for (std::int32_t& length : thick) length = std::max(length, kLeastVoxels);
  if (thick != image.size) {
    return WithSize(WithoutBiasField(WithSize(image, thick), filter, stop), image.size);
  }
  const auto import = Import(image.values, image.size, image.spacing);
  import->Update();
  FloatImage* const whole = import->GetOutput();
  const FloatImage::Pointer blocks = Blocks(image, whole, stop);
  const MaskImage::Pointer mask = Foreground(*blocks);
  if (!mask) return image;
  const Lattice::Pointer lattice = FieldOf(blocks, mask, filter, stop);
  const double mean = MeanInMask(*Reconstruct(lattice, *blocks, stop), *mask);
  const FloatImage::Pointer field = Reconstruct(lattice, *whole, stop);
  VolumeImage result = image;
  for (std::size_t v = 0; v < result.values.size(); ++v) {
    ThrowIfStopped(stop);
    float& value = result.values[v];
    if (value > 0) value /= static_cast<float>(std::exp(static_cast<double>(field->GetBufferPointer()[v]) - mean));
  }
  return result;
}

}  // namespace fascicle
