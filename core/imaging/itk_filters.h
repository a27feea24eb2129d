#ifndef FASCICLE_CORE_IMAGING_ITK_FILTERS_H_
#define FASCICLE_CORE_IMAGING_ITK_FILTERS_H_

#include "core/imaging/filters.h"
#include "core/imaging/volume_image.h"

// ITK's filters, run with the given number of threads. Internal to this room.
namespace fascicle {

VolumeImage GaussianOf(const VolumeImage& image, const GaussianFilter& filter, int threads);
VolumeImage DiffusedOf(const VolumeImage& image, const CurvatureFilter& filter, int threads);

}  // namespace fascicle

#endif  // FASCICLE_CORE_IMAGING_ITK_FILTERS_H_
