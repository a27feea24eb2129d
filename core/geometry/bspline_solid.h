#ifndef FASCICLE_CORE_GEOMETRY_BSPLINE_SOLID_H_
#define FASCICLE_CORE_GEOMETRY_BSPLINE_SOLID_H_

#include <array>
#include <cstddef>
#include <vector>

#include "core/base/types.h"
#include "core/geometry/bspline_basis.h"

namespace fascicle {

// x(u, v, w) = sum_ijk B_i(u) B_j(v) B_k(w) q_ijk [Teran 2003, 6; Ng-Thow-Hing 2001]. Const after construction.
class BsplineSolid {
 public:
  using Bases = std::array<BsplineBasis, 3>;

  struct Point {
    Vec3 position;   // [m]
    Mat3 gradients;  // columns dx/du, dx/dv, dx/dw [m]
  };

  // Control points [m] with u running fastest: q_ijk is controls[i + nu (j + nv k)].
  BsplineSolid(Bases bases, std::vector<Vec3> controls);

  const Bases& bases() const { return bases_; }
  const std::vector<Vec3>& controls() const { return controls_; }
  Vec3 lowest() const { return {bases_[0].front(), bases_[1].front(), bases_[2].front()}; }
  Vec3 highest() const { return {bases_[0].back(), bases_[1].back(), bases_[2].back()}; }

  // Evaluates at parameters (u, v, w), which are clamped to their box.
  Point At(const Vec3& parameters) const;

 private:
  Bases bases_;
  std::vector<Vec3> controls_;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_BSPLINE_SOLID_H_
