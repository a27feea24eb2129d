#ifndef FASCICLE_CORE_IMAGING_BIAS_FIELD_H_
#define FASCICLE_CORE_IMAGING_BIAS_FIELD_H_

#include "core/imaging/filters.h"
#include "core/imaging/volume_image.h"

namespace fascicle {

// The image divided by its coil's field: ApplyFilter of a BiasFieldFilter. Works on up to four threads; the bits do not
// depend on how many there are. An image without two different values above 0 comes back as it was.
VolumeImage WithoutBiasField(const VolumeImage& image, const BiasFieldFilter& filter);

}  // namespace fascicle

#endif  // FASCICLE_CORE_IMAGING_BIAS_FIELD_H_
