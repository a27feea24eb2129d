#ifndef FASCICLE_CLIENT_LIB_TETRAHEDRA_H_
#define FASCICLE_CLIENT_LIB_TETRAHEDRA_H_

#include <array>
#include <utility>
#include <vector>

#include "client/lib/decode.h"

// Geometry of a body's tetrahedra, straight or with mid-edge nodes, as the solver computes it. `x` are positions of all
// nodes of the body, at rest or deformed [m]; `t` is the index of a tetrahedron. All functions are pure.
namespace fascicle::client {

// Barycentric coordinates.
using Barycentric = std::array<double, 4>;
inline constexpr Barycentric kCentroid = {0.25, 0.25, 0.25, 0.25};

// The four quadrature points of a quadratic tetrahedron, of equal weight.
std::array<Barycentric, 4> QuadraturePoints();

// The edges 01, 02, 03 of the straight tetrahedron with the same Jacobian as tetrahedron t at a point [m]: F there is
// EdgesAt(deformed) EdgesAt(rest)^-1, the volume ratio the quotient of their determinants.
Mat3 EdgesAt(const BodyShape& shape, std::size_t t, const std::vector<Vec3>& x, const Barycentric& point);

// [m^3], by the quadrature of the solver.
double VolumeOf(const BodyShape& shape, std::size_t t, const std::vector<Vec3>& x);

// The nodes of a tetrahedron with the values of their shape functions at a point: they add up to 1.
std::vector<std::pair<std::uint32_t, double>> WeightsAt(const BodyShape& shape, std::size_t t,
                                                        const Barycentric& point);

// A triangle of the surface of a body, and its mid-edge nodes on 01 12 20, if it has any.
struct SurfaceTriangle {
  std::size_t tetrahedron = 0;
  std::array<std::uint32_t, 3> corners;  // counter-clockwise seen from outside
  std::array<std::uint32_t, 3> middles;  // only of quadratic tetrahedra
};

// The triangles that belong to one tetrahedron only, in the order of their corners.
std::vector<SurfaceTriangle> SurfaceTriangles(const BodyShape& shape);

// A triangle as flat ones: itself, or 64 parts of a curved one.
std::vector<std::array<Vec3, 3>> FlatParts(const SurfaceTriangle& triangle, bool quadratic, const std::vector<Vec3>& x);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_LIB_TETRAHEDRA_H_
