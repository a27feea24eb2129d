#include "core/skeleton/skeleton_motion.h"

#include <algorithm>
#include <cstddef>

namespace fascicle {

double CoordinateMotion::At(double time, int derivative) const {
  if (derivative > 0 && (time < first || time > last || first == last)) return 0;
  return function.At(std::clamp(time, first, last), derivative);
}

Eigen::VectorXd SkeletonMotion::At(double time, int derivative) const {
  Eigen::VectorXd values(static_cast<Eigen::Index>(coordinates.size()));
  for (std::size_t k = 0; k < coordinates.size(); ++k) {
    values[static_cast<Eigen::Index>(k)] = coordinates[k].At(time, derivative);
  }
  return values;
}

double SkeletonMotion::end() const {
  double end = 0;
  for (const CoordinateMotion& coordinate : coordinates) end = std::max(end, coordinate.last);
  return end;
}

}  // namespace fascicle
