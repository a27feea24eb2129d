#ifndef FASCICLE_CORE_MUSCLE_LAPLACE_H_
#define FASCICLE_CORE_MUSCLE_LAPLACE_H_

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "core/geometry/tet_mesh.h"

namespace fascicle {

// Gradients of the four linear shape functions, [1/m], and the volume [m^3].
struct LinearElement {
  std::array<Vec3, 4> gradients;
  double volume;
};

LinearElement MakeLinearElement(const TetMesh& mesh, std::size_t tetrahedron);

// laplace(phi) = 0 with linear finite elements, phi given at the nodes `fixed`, no flux elsewhere. `values` has one
// column for each potential and holds what is given; conjugate gradients to a relative residual of 1e-12, in sequence:
// the same bits on every run. Nothing where these fail, as on flat tetrahedra.
std::optional<Eigen::MatrixXd> SolveLaplace(const TetMesh& mesh, const std::vector<bool>& fixed,
                                            Eigen::MatrixXd values);

}  // namespace fascicle

#endif  // FASCICLE_CORE_MUSCLE_LAPLACE_H_
