#ifndef FASCICLE_CORE_IMAGING_ITK_FILTERS_H_
#define FASCICLE_CORE_IMAGING_ITK_FILTERS_H_

#include <vector>

#include "core/imaging/filters.h"
#include "core/imaging/volume_image.h"

// The filters that are ITK's, on so many threads. For this room alone.
namespace fascicle {

VolumeImage GaussianOf(const VolumeImage& image, const GaussianFilter& filter, int threads);
VolumeImage DiffusedOf(const VolumeImage& image, const CurvatureFilter& filter, int threads);

// Of each voxel of a box, the distance of its centre to that of the nearest marked one [m], 0 in marked ones [Maurer
// 2003]. At least one must be marked.
std::vector<float> DistancesTo(const std::vector<std::uint8_t>& marked, const GridIndex& size, const Vec3& spacing,
                               int threads);

}  // namespace fascicle

#endif  // FASCICLE_CORE_IMAGING_ITK_FILTERS_H_
