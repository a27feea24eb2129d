#ifndef FASCICLE_CORE_GEOMETRY_BSPLINE_LOCATOR_H_
#define FASCICLE_CORE_GEOMETRY_BSPLINE_LOCATOR_H_

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "core/base/parallel.h"
#include "core/geometry/bspline_solid.h"

namespace fascicle {

// The parameters of a point, or of the nearest point of the solid.
struct BsplineLocation {
  Vec3 parameters;
  double distance;  // distance from the solid [m]
  bool inside;      // whether the distance is zero up to round-off
};

// Inverts x(u, v, w) = p by Newton's method on |x - p|^2, damped where a step does not descend [Nocedal and Wright
// 2006, 10.3] and restricted to the parameter box, starting from the nearest samples of the solid. For a regular solid
// (positive Jacobian) the parameters of interior points are accurate to about round-off times the condition number of
// the gradients. Const and thread-safe.
class BsplineLocator {
 public:
  explicit BsplineLocator(BsplineSolid solid);
  ~BsplineLocator();

  const BsplineSolid& solid() const;
  BsplineLocation Locate(const Vec3& point) const;
  // Points are independent of each other: the same bits for any number of threads. Observes the team's stop requests.
  std::vector<BsplineLocation> Locate(std::span<const Vec3> points, ThreadTeam& team) const;

 private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_BSPLINE_LOCATOR_H_
