#ifndef FASCICLE_CORE_IMAGING_FILTERS_H_
#define FASCICLE_CORE_IMAGING_FILTERS_H_

#include <variant>

#include "core/base/parallel.h"
#include "core/imaging/volume_image.h"

namespace fascicle {

// Convolves with a Gaussian of the given standard deviation [m], isotropic in space whatever the spacing: the discrete
// kernel of [Lindeberg 1994].
struct GaussianFilter {
  double deviation = 1e-3;  // [m], > 0, at most 20 voxels

  bool operator==(const GaussianFilter&) const = default;
};

// Smooths along isosurfaces and keeps edges: modified curvature diffusion [Whitaker and Xue 2001].
struct CurvatureFilter {
  int iterations = 5;      // 1 to 100
  double conductance = 1;  // [1], > 0: edges weaker than this, relative to the mean gradient, are smoothed

  bool operator==(const CurvatureFilter&) const = default;
};

// Removes noise scale by scale with undecimated B3-spline wavelets (a trous) [Starck and Murtagh 1994]. Coefficients w
// are shrunk to w (1 - (t/w)^2), or to 0 below t [non-negative garrote; Gao 1998], where t is `threshold` times the
// standard deviation of the noise at their scale. The noise is assumed to be white and estimated at the finest scale
// (EstimateNoise). With threshold 0 the image is unchanged.
struct WaveletFilter {
  int scales = 3;        // 1 to 8, limited by the size of the image: the coarsest scale is 2^scales voxels wide
  double threshold = 3;  // [1], >= 0

  bool operator==(const WaveletFilter&) const = default;
};

// Divides by the smooth bias field, the spatial variation of the receiving coil's sensitivity: N4 [Tustison 2010,
// N4ITK: improved N3 bias correction]. The field is a cubic B-spline whose grid initially has one cell. It is fitted to
// the foreground, which is brighter than the darker of Otsu's two classes, and its logarithm has zero mean there. Only
// values above 0 change.
struct BiasFieldFilter {
  int refinements = 3;  // 0 to 5: how often the grid's spacing is halved
  int iterations = 50;  // 1 to 500: on each grid; fewer once the field has converged

  bool operator==(const BiasFieldFilter&) const = default;
};

using ImageFilter = std::variant<GaussianFilter, CurvatureFilter, WaveletFilter, BiasFieldFilter>;

// The filtered image; the same bits for any number of threads. Settings must be valid (CheckImageStage). Observes
// the team's stop requests.
VolumeImage ApplyFilter(const VolumeImage& image, const ImageFilter& filter, ThreadTeam& team);

// Standard deviation of an image's noise, from the median absolute deviation of the finest wavelet coefficients [unit
// of the values]. Voxels of value 0, as in a masked background, are excluded.
double EstimateNoise(const VolumeImage& image, ThreadTeam& team);

}  // namespace fascicle

#endif  // FASCICLE_CORE_IMAGING_FILTERS_H_
