#ifndef FASCICLE_CORE_IMAGING_ITK_FILTERS_H_
#define FASCICLE_CORE_IMAGING_ITK_FILTERS_H_

#include "core/imaging/filters.h"
#include "core/imaging/volume_image.h"

// The filters that are ITK's, on so many threads. For this room alone.
namespace fascicle {

VolumeImage GaussianOf(const VolumeImage& image, const GaussianFilter& filter, int threads);
VolumeImage DiffusedOf(const VolumeImage& image, const CurvatureFilter& filter, int threads);

}  // namespace fascicle

#endif  // FASCICLE_CORE_IMAGING_ITK_FILTERS_H_
