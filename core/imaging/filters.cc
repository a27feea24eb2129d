#include "core/imaging/filters.h"

#include "core/imaging/bias_field.h"
#include "core/imaging/itk_filters.h"
#include "core/imaging/wavelet.h"

namespace fascicle {

VolumeImage ApplyFilter(const VolumeImage& image, const ImageFilter& filter, ThreadTeam& team) {
  if (const auto* gaussian = std::get_if<GaussianFilter>(&filter)) return GaussianOf(image, *gaussian, team);
  if (const auto* curvature = std::get_if<CurvatureFilter>(&filter)) return DiffusedOf(image, *curvature, team);
  if (const auto* bias = std::get_if<BiasFieldFilter>(&filter)) return WithoutBiasField(image, *bias, team.stop());
  return WaveletFiltered(image, std::get<WaveletFilter>(filter), team);
}

}  // namespace fascicle
