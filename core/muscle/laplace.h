#ifndef FASCICLE_CORE_MUSCLE_LAPLACE_H_
#define FASCICLE_CORE_MUSCLE_LAPLACE_H_

#include <array>
#include <cstddef>
#include <optional>
#include <stop_token>
#include <vector>

#include "core/geometry/tet_mesh.h"

namespace fascicle {

// Gradients of the four linear shape functions, [1/m], and the volume [m^3].
struct LinearElement {
  std::array<Vec3, 4> gradients;
  double volume;
};

LinearElement MakeLinearElement(const TetMesh& mesh, std::size_t tetrahedron);

// Solves laplace(phi) = 0 with linear finite elements, phi prescribed at the nodes `fixed`, no flux elsewhere. `values`
// has one column for each potential and contains the prescribed values. Conjugate gradients to a relative residual of
// 1e-12 on one thread: the same bits on every run. Returns nothing if they fail, as with flat tetrahedra. Throws
// Stopped after a stop request.
std::optional<Eigen::MatrixXd> SolveLaplace(const TetMesh& mesh, const std::vector<bool>& fixed, Eigen::MatrixXd values,
                                            const std::stop_token& stop);

}  // namespace fascicle

#endif  // FASCICLE_CORE_MUSCLE_LAPLACE_H_
