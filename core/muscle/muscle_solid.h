#ifndef FASCICLE_CORE_MUSCLE_MUSCLE_SOLID_H_
#define FASCICLE_CORE_MUSCLE_MUSCLE_SOLID_H_

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <stop_token>

#include "core/base/problems.h"
#include "core/geometry/bspline_fit.h"
#include "core/geometry/tet_mesh.h"

namespace fascicle {

struct MuscleSolidOptions {
  std::array<int, 3> degrees = {3, 3, 3};    // along u, v, w; 1 to 5
  std::array<int, 3> controls = {5, 5, 16};  // along u, v, w; each larger than its degree
  double smoothing = 1e-3;                   // see FitBsplineSolid
};

// A B-spline solid on [0, 1]^3 fitted to the nodes of a muscle, with w from the origin to the insertion. Parameters of
// the nodes:
//   w      length of the middle line up to the node's slice along the harmonic potential between both regions
//   u, v   on the lateral surface: the circle around (1/2, 1/2), by the angle about the middle line in the slice's
//          cross-section, scaled to be round; inside: harmonic
// so that lines of constant (u, v) follow the surface. The corners of the (u, v) square lie outside of the circle and
// carry no fibres. Adds problems and returns nothing in the cases of HarmonicFibres, if there is no fit, or if the fit
// is not close to the nodes. Throws Stopped after a stop request.
std::optional<SolidFit> FitMuscleSolid(const TetMesh& mesh, std::span<const std::int32_t> origin,
                                       std::span<const std::int32_t> insertion, const MuscleSolidOptions& options,
                                       Problems& problems, const std::stop_token& stop = {});

}  // namespace fascicle

#endif  // FASCICLE_CORE_MUSCLE_MUSCLE_SOLID_H_
