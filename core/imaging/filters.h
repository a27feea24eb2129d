#ifndef FASCICLE_CORE_IMAGING_FILTERS_H_
#define FASCICLE_CORE_IMAGING_FILTERS_H_

#include <variant>

#include "core/base/parallel.h"
#include "core/imaging/volume_image.h"

namespace fascicle {

// Blurs by a Gaussian of that standard deviation [m], the same in all directions whatever the spacing: the discrete
// kernel of [Lindeberg 1994].
struct GaussianFilter {
  double deviation = 1e-3;  // [m], > 0, at most 20 voxels

  bool operator==(const GaussianFilter&) const = default;
};

// Smooths along surfaces of equal value and keeps edges: modified curvature diffusion [Whitaker and Xue 2001].
struct CurvatureFilter {
  int iterations = 5;      // 1 to 100
  double conductance = 1;  // [1], > 0: edges weaker than this, against the mean gradient, are smoothed

  bool operator==(const CurvatureFilter&) const = default;
};

// Takes the noise out scale by scale: undecimated B3-spline wavelets (a trous) [Starck and Murtagh 1994], whose
// coefficients w are shrunk to w (1 - (t/w)^2), or 0 below t [non-negative garrote; Gao 1998], where t is `threshold`
// deviations of the noise at their scale. The noise is estimated at the finest scale (EstimateNoise) and white. With
// threshold 0 the image stays as it was.
struct WaveletFilter {
  int scales = 3;        // 1 to 8, as far as the image is large enough: the coarsest is 2^scales voxels wide
  double threshold = 3;  // [1], >= 0

  bool operator==(const WaveletFilter&) const = default;
};

// Divides by the smooth field by which the receiving coil's sensitivity varies over the image: N4 [Tustison 2010,
// N4ITK: improved N3 bias correction]. The field is a cubic B-spline whose grid is one cell at first; its logarithm is
// 0 in the mean over what is brighter than the darker of two classes of Otsu, from which it is found. For values above
// 0; others stay as they are.
struct BiasFieldFilter {
  int refinements = 3;  // 0 to 5: times that the grid is halved
  int iterations = 50;  // 1 to 500: on each grid, fewer where the field no longer changes

  bool operator==(const BiasFieldFilter&) const = default;
};

using ImageFilter = std::variant<GaussianFilter, CurvatureFilter, WaveletFilter, BiasFieldFilter>;

// The filtered image: the same bits for any number of threads. Settings must be in their ranges (CheckImageStage).
VolumeImage ApplyFilter(const VolumeImage& image, const ImageFilter& filter, ThreadTeam& team);

// Standard deviation of the noise of an image, from the median absolute deviation of the finest wavelet coefficients
// [the values' unit]. Voxels of value 0, as masked background has, don't count.
double EstimateNoise(const VolumeImage& image, ThreadTeam& team);

}  // namespace fascicle

#endif  // FASCICLE_CORE_IMAGING_FILTERS_H_
