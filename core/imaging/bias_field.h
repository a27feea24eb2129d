#ifndef FASCICLE_CORE_IMAGING_BIAS_FIELD_H_
#define FASCICLE_CORE_IMAGING_BIAS_FIELD_H_

#include <stop_token>

#include "core/imaging/filters.h"
#include "core/imaging/volume_image.h"

namespace fascicle {

// Divides the image by its bias field: ApplyFilter for a BiasFieldFilter. Uses up to four threads; the bits do not
// depend on their number. An image without two different values above 0 is returned unchanged. Throws Stopped after a
// stop request.
VolumeImage WithoutBiasField(const VolumeImage& image, const BiasFieldFilter& filter, const std::stop_token& stop);

}  // namespace fascicle

#endif  // FASCICLE_CORE_IMAGING_BIAS_FIELD_H_
