#ifndef FASCICLE_CORE_MUSCLE_FIBRE_FIELD_H_
#define FASCICLE_CORE_MUSCLE_FIBRE_FIELD_H_

#include <cstdint>
#include <span>
#include <stop_token>
#include <string_view>
#include <vector>

#include "core/base/problems.h"
#include "core/geometry/tet_mesh.h"

namespace fascicle {

// A unit rest direction a0 for each element, tetrahedron or hexahedron, of a mesh.
using FibreField = std::vector<Vec3>;

// The directions of the elements from those of the tetrahedra: of each hexahedron the mean, by volume, over its six; of
// tetrahedra as they are. No directions remain none.
FibreField OfElements(const TetMesh& mesh, FibreField of_tetrahedra);

// The same direction everywhere; `direction` has any non-zero length.
FibreField ConstantFibres(const TetMesh& mesh, const Vec3& direction);

// Reads one vector per line, one line per element in their order; `#` starts a comment. Vectors are normalized.
// Adds problems (with empty paths) and returns nothing where lines are missing, surplus, not three finite numbers, or
// zero.
FibreField ReadFibres(const TetMesh& mesh, std::string_view text, Problems& problems);

// Gradient of the potential phi with laplace(phi) = 0, phi = 0 on the nodes `origin`, 1 on `insertion`, no flux
// elsewhere. A direction for each tetrahedron. Linear finite elements; conjugate gradients to a relative residual of
// 1e-12, so that an exact field, such as that of a box, is found to 1e-8. Where the gradient vanishes, as in tetrahedra
// all of whose nodes belong to one region, the direction is taken from the neighbours. Runs on one thread: the same
// bits on every run. Adds a problem and returns nothing if a region is empty or refers to a node that does not exist,
// if regions overlap, if a part of the mesh is not connected to both regions, or if the solver does not converge.
// Throws Stopped after a stop request.
FibreField HarmonicFibres(const TetMesh& mesh, std::span<const std::int32_t> origin,
                          std::span<const std::int32_t> insertion, Problems& problems,
                          const std::stop_token& stop = {});

}  // namespace fascicle

#endif  // FASCICLE_CORE_MUSCLE_FIBRE_FIELD_H_
