#ifndef FASCICLE_CORE_GEOMETRY_BSPLINE_LOCATOR_H_
#define FASCICLE_CORE_GEOMETRY_BSPLINE_LOCATOR_H_

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "core/base/parallel.h"
#include "core/geometry/bspline_solid.h"

namespace fascicle {

// The parameters of a point of space, or of the point of the solid that is nearest to it.
struct BsplineLocation {
  Vec3 parameters;
  double distance;  // from the solid [m]
  bool inside;      // the distance is within round-off
};

// Inverts x(u, v, w) = p: Newton steps on |x - p|^2, damped where they don't descend [Nocedal and Wright 2006, 10.3]
// and kept in the parameter box, from the nearest samples of the solid. For a regular solid (positive Jacobian)
// parameters of points inside are found to about the round-off times the condition of the gradients. Const and
// thread-safe.
class BsplineLocator {
 public:
  explicit BsplineLocator(BsplineSolid solid);
  ~BsplineLocator();

  const BsplineSolid& solid() const;
  BsplineLocation Locate(const Vec3& point) const;
  // Each point on its own: the same bits for any number of threads.
  std::vector<BsplineLocation> Locate(std::span<const Vec3> points, ThreadTeam& team) const;

 private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_BSPLINE_LOCATOR_H_
