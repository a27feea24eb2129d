#ifndef FASCICLE_CORE_IMAGING_WAVELET_H_
#define FASCICLE_CORE_IMAGING_WAVELET_H_

#include <vector>

#include "core/imaging/filters.h"
#include "core/imaging/volume_image.h"

// Undecimated (a trous) wavelets of the cubic B-spline [Starck and Murtagh 1994]: c_0 is the image, c_s is c_{s-1}
// convolved along each axis with (1 4 6 4 1) / 16, with 2^(s-1) - 1 zeros between the weights, and w_s = c_{s-1} - c_s.
// The image is the sum of all w_s and the last c_s. Reflected at the boundary. Internal to this room.
namespace fascicle {

// c_s from c_{s-1}, for a scale s >= 1.
std::vector<float> Blurred(const std::vector<float>& values, const GridIndex& size, int scale, ThreadTeam& team);

// Standard deviation of w_s for an image of white noise with standard deviation 1. An axis with a single voxel is not
// blurred.
double NoiseGain(const GridIndex& size, int scale);

VolumeImage WaveletFiltered(const VolumeImage& image, const WaveletFilter& filter, ThreadTeam& team);

}  // namespace fascicle

#endif  // FASCICLE_CORE_IMAGING_WAVELET_H_
