#ifndef FASCICLE_CORE_GEOMETRY_BSPLINE_FIT_H_
#define FASCICLE_CORE_GEOMETRY_BSPLINE_FIT_H_

#include <optional>
#include <span>
#include <stop_token>

#include "core/geometry/bspline_solid.h"

namespace fascicle {

// A position that the solid should have at given parameters.
struct SolidSample {
  Vec3 parameters;
  Vec3 position;  // [m]
};

struct SolidFit {
  BsplineSolid solid;
  double rms = 0, max = 0;  // distances between samples and the solid at their parameters [m]
};

// The control points q that minimize
//   mean over samples of |x(parameters) - position|^2  +  smoothing * mean over control points of |second
//   difference|^2.
// Second differences are those of the control net along each direction, divided by the distances of the Greville points
// and multiplied by the mean distance squared, so that they vanish for every trilinear map [after Eilers and Marx
// 1996]. Smoothing also determines control points that no sample reaches. Sparse Cholesky factorization on one thread:
// the same bits on every run. Returns nothing when the samples don't determine a solid. Throws Stopped after a stop
// request; the Cholesky factorization comes to its end before.
std::optional<SolidFit> FitBsplineSolid(BsplineSolid::Bases bases, std::span<const SolidSample> samples,
                                        double smoothing, const std::stop_token& stop = {});

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_BSPLINE_FIT_H_
