#ifndef FASCICLE_CORE_IMAGING_ITK_FILTERS_H_
#define FASCICLE_CORE_IMAGING_ITK_FILTERS_H_

#include "core/imaging/filters.h"
#include "core/imaging/volume_image.h"

// ITK's filters, run with as many threads as the team has; they observe its stop requests. Internal to this room.
namespace fascicle {

VolumeImage GaussianOf(const VolumeImage& image, const GaussianFilter& filter, const ThreadTeam& team);
VolumeImage DiffusedOf(const VolumeImage& image, const CurvatureFilter& filter, const ThreadTeam& team);

}  // namespace fascicle

#endif  // FASCICLE_CORE_IMAGING_ITK_FILTERS_H_
