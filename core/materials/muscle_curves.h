#ifndef FASCICLE_CORE_MATERIALS_MUSCLE_CURVES_H_
#define FASCICLE_CORE_MATERIALS_MUSCLE_CURVES_H_

#include <cstdint>
#include <string_view>
#include <vector>

#include "core/base/problems.h"
#include "core/materials/point_curve.h"

namespace fascicle {

// What the values of a muscle's curves are, times the peak stress.
enum class CurveStress : std::int64_t {
  kForce,   // the fibre's force over its area at the optimal length: Cauchy stress over the normalized length
  kCauchy,  // the Cauchy stress along the fibre
};

// The curves of a muscle's fibres as functions of the normalized length r and velocity v [1]. v is the rate of r over
// the maximum shortening velocity, positive while the fibre lengthens. Nothing but numbers.
struct MuscleCurves {
  PointCurve active_length;   // f_act(r)
  PointCurve passive_length;  // f_pass(r)
  PointCurve force_velocity;  // f_v(v), f_v(0) = 1
  CurveStress stress = CurveStress::kForce;

  // Integral of f_act(r) f_v(velocity_per_length (r - from)) over r from `from` to `to`, with CurveStress::kCauchy of
  // the same over r: the work of a step in which the fibre's normalized length changes so. By quadrature, exact to
  // round-off.
  double ActiveWork(double from, double to, double velocity_per_length) const;
};

// Published sets of curves.
enum class PublishedCurves {
  // Gaussian active curve of width 0.45, exponential passive curve with shape 5 and strain 0.6, Hill's hyperbola with
  // a/F0 = 0.25 and a plateau of 1.4. Forces. [Thelen 2003, J. Biomech. Eng. 125, young adults; the force-velocity
  // curve at full activation]
  kThelen2003,
  // Sum of Gaussians, exponential with shape 4 and strain 0.6, logarithmic force-velocity curve. Forces. [De Groote,
  // Kinney, Rao, Fregly 2016, Ann. Biomed. Eng. 44]
  kDeGroote2016,
  // Sum of sines, piecewise quadratic passive curve, piecewise cubic force-velocity curve. Cauchy stresses. [Almonacid
  // et al. 2024, A three-dimensional model of skeletal muscle tissues, SIAM J. Appl. Math.]
  kAlmonacid2024,
};

// Each curve is the cubic through points of the published one, with its slopes there. Where a published curve jumps at
// the end of its range or has a kink there, this one is continuous. Differences are below 0.005, see
// tests/core/materials.
MuscleCurves CurvesOf(PublishedCurves set);

// A user's points of one curve.
struct CurveTable {
  std::vector<double> at;      // normalized lengths, or velocities
  std::vector<double> values;  // normalized stresses
};

// Each checks a table and adds problems at the paths of its fields, `positions` ("lengths", "velocities") and
// "values", and is the curve through its points; the other curve's `fallback` if there are any.
//   active   values >= 0; constant beyond the points
//   passive  from 0, never falling; beyond the last point a straight line
//   velocity values >= 0, never falling, with a point (0, 1); constant beyond the points
PointCurve ActiveLengthCurve(const CurveTable& table, const PointCurve& fallback, Problems& problems);
PointCurve PassiveLengthCurve(const CurveTable& table, const PointCurve& fallback, Problems& problems);
PointCurve VelocityCurve(const CurveTable& table, const PointCurve& fallback, Problems& problems);

}  // namespace fascicle

#endif  // FASCICLE_CORE_MATERIALS_MUSCLE_CURVES_H_
