#ifndef FASCICLE_SERVER_TRANSLATE_CURVES_H_
#define FASCICLE_SERVER_TRANSLATE_CURVES_H_

#include <string>

#include "core/base/curve.h"
#include "core/base/problems.h"
#include "fascicle/v1/scene.pb.h"

namespace fascicle::server {

// Meaning and range of a curve's values, which scene.proto gives at each use, because rule lines cannot.
struct CurveUse {
  const char* unit;
  double min, max;  // inclusive
  double neutral;   // constant value that replaces an invalid curve in later checks
};
inline constexpr CurveUse kActivationCurve = {"1", 0, 1, 0};
inline constexpr CurveUse kFactorCurve = {"1", -1000, 1000, 1};
inline constexpr CurveUse kTranslationCurve = {"m", -10, 10, 0};
inline constexpr CurveUse kJointAngleCurve = {"rad", 0, 3.14159, 0};
inline constexpr CurveUse kAngleCurve = {"rad", -1000, 1000, 0};

Curve::Interpolation InterpolationOf(v1::Interpolation interpolation);

// Problems: more than 10,000 points, different numbers of values and times, times that don't increase, values out of
// range.
Curve TranslateCurve(const v1::Curve& curve, const CurveUse& use, const std::string& path, Problems& problems);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_TRANSLATE_CURVES_H_
