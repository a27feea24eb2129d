#ifndef FASCICLE_CORE_MATERIALS_CURVE_FIT_H_
#define FASCICLE_CORE_MATERIALS_CURVE_FIT_H_

#include <cstddef>
#include <span>
#include <vector>

#include "core/materials/material.h"
#include "core/materials/uniaxial_curve.h"

namespace fascicle {

// A point of a measured tension test with free sides along the fibres.
struct MeasuredPoint {
  double stretch = 1;         // > 0
  double nominal_stress = 0;  // force per rest area [Pa]
};

// Parameters of a law and how far its stresses are from the measured ones.
struct CurveFit {
  std::vector<double> values;    // all parameters of the law
  std::vector<double> stresses;  // nominal stress of the law at each point [Pa]; NaN where there is no lateral stretch
  double residual = 0;           // root mean square of the differences [Pa]
  int iterations = 0;
  bool converged = false;  // whether the last step changed no parameter by more than 1e-8 of itself
};

// Stresses and residual of a law at measured points, nothing fitted. Requires points.
CurveFit CompareWithCurve(const LawInfo& law, std::vector<double> values, const Contraction& contraction,
                          std::span<const MeasuredPoint> points);

// The parameters `free` (indices into law.parameters) that minimize the residual within their ranges, from `start`, by
// the method of Levenberg and Marquardt with steps limited to the ranges; a local minimum where the problem has
// several. Requires points, values within their ranges, and free indices in ascending order. Deterministic. [Marquardt
// 1963, J. Soc. Ind. Appl. Math. 11]
CurveFit FitToCurve(const LawInfo& law, std::vector<double> start, std::span<const std::size_t> free,
                    const Contraction& contraction, std::span<const MeasuredPoint> points);

}  // namespace fascicle

#endif  // FASCICLE_CORE_MATERIALS_CURVE_FIT_H_
