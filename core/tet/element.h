#ifndef FASCICLE_CORE_TET_ELEMENT_H_
#define FASCICLE_CORE_TET_ELEMENT_H_

#include <Eigen/Geometry>

#include "core/geometry/tet_mesh.h"
#include "core/linalg/nodal_vector.h"

// The arithmetic of one tetrahedron [Teran 2003, 3 and 4].
namespace fascicle {

// [a1 - a0, a2 - a0, a3 - a0] of the values a at the corners: Dm of rest positions, Ds of positions, their rates of
// velocities.
inline Mat3 EdgeMatrix(const NodalVector& values, const Tetrahedron& corners) {
  const Vec3& origin = values[corners[0]];
  Mat3 edges;
  edges.col(0) = values[corners[1]] - origin;
  edges.col(1) = values[corners[2]] - origin;
  edges.col(2) = values[corners[3]] - origin;
  return edges;
}

inline double Determinant(const Mat3& F) { return F.col(0).dot(F.col(1).cross(F.col(2))); }

// Second Piola-Kirchhoff viscous stress S_v = 2 mu Edot + lambda tr(Edot) I, Edot = sym(F^T Fdot): zero in any rigid
// motion, and S_v : Edot >= 0.
struct ViscousStress {
  ViscousStress(const Mat3& F, const Mat3& F_rate, double mu, double lambda) {
    const Mat3 product = F.transpose() * F_rate;
    const Mat3 rate = 0.5 * (product + product.transpose());
    const double trace = rate.trace();
    S = 2 * mu * rate;
    S.diagonal().array() += lambda * trace;
    power = 2 * mu * rate.squaredNorm() + lambda * trace * trace;
  }

  Mat3 S;        // [Pa]
  double power;  // dissipated, S_v : Edot [W/m^3]
};

// Forces at the corners [N].
using CornerForces = std::array<Vec3, 4>;

// [f1 f2 f3] = P Bm3 = -V P Dm^-T, f0 = -(f1 + f2 + f3) [Teran 2003, 4.1].
inline void SetCornerForces(const Mat3& P, const Mat3& Dm_inverse, double volume, CornerForces& forces) {
  const Mat3 f = (-volume * P) * Dm_inverse.transpose();
  forces[1] = f.col(0);
  forces[2] = f.col(1);
  forces[3] = f.col(2);
  forces[0] = -(forces[1] + forces[2] + forces[3]);
}

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_ELEMENT_H_
