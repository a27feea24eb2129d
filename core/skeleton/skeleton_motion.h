#ifndef FASCICLE_CORE_SKELETON_SKELETON_MOTION_H_
#define FASCICLE_CORE_SKELETON_SKELETON_MOTION_H_

#include <Eigen/Core>

#include <vector>

#include "core/skeleton/scalar_function.h"

namespace fascicle {

// A coordinate over time: a function between two times, constant before and after them.
struct CoordinateMotion {
  ScalarFunction function;
  double first = 0, last = 0;  // [s]

  static CoordinateMotion Constant(double value) { return {ScalarFunction::Constant(value), 0, 0}; }
  // The value [rad or m], or the first or the second derivative.
  double At(double time, int derivative = 0) const;
};

// All coordinates of a skeleton over time.
struct SkeletonMotion {
  std::vector<CoordinateMotion> coordinates;

  Eigen::VectorXd At(double time, int derivative = 0) const;
  // The time from which nothing moves [s].
  double end() const;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_SKELETON_SKELETON_MOTION_H_
