#ifndef FASCICLE_CORE_MUSCLE_FIBRE_FIELD_H_
#define FASCICLE_CORE_MUSCLE_FIBRE_FIELD_H_

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "core/base/problems.h"
#include "core/geometry/tet_mesh.h"

namespace fascicle {

// One unit rest direction a0 for each tetrahedron.
using FibreField = std::vector<Vec3>;

// The same direction everywhere; `direction` of any non-zero length.
FibreField ConstantFibres(const TetMesh& mesh, const Vec3& direction);

// One vector a line, as many as tetrahedra, in their order; `#` starts a comment; normalized. Adds to `problems` (paths
// empty) and returns nothing where lines are missing, surplus, not three finite numbers, or zero.
FibreField ReadFibres(const TetMesh& mesh, std::string_view text, Problems& problems);

// Gradient of the potential phi with laplace(phi) = 0, phi = 0 on the nodes `origin`, 1 on `insertion`, no flux
// elsewhere: linear finite elements, conjugate gradients to a relative residual of 1e-12 (so that an exact field, such
// as that of a box, is found to 1e-8). Where the gradient vanishes, as in tetrahedra all of whose nodes belong to one
// region, the direction is taken from the neighbours. Sequential: the same bits on every run. Problems (nothing is
// returned): a region that is empty or names a node that is not there, overlapping regions, a part of the mesh without
// a path to both regions, no convergence.
FibreField HarmonicFibres(const TetMesh& mesh, std::span<const std::int32_t> origin,
                          std::span<const std::int32_t> insertion, Problems& problems);

}  // namespace fascicle

#endif  // FASCICLE_CORE_MUSCLE_FIBRE_FIELD_H_
