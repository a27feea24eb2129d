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

// One vector a line, as many as tetrahedra, `#` starts a comment; normalized. Adds to `problems` (paths empty) and
// returns nothing where lines are missing, surplus, not numbers, or zero.
FibreField ReadFibres(const TetMesh& mesh, std::string_view text, Problems& problems);

// Gradient of the potential phi with laplace(phi) = 0, phi = 0 on `origin`, 1 on `insertion`, no flux elsewhere: linear
// finite elements, conjugate gradients to 1e-10. Where the gradient vanishes the direction is taken from the
// neighbours. Problems: empty or overlapping regions.
FibreField HarmonicFibres(const TetMesh& mesh, std::span<const std::int32_t> origin, std::span<const std::int32_t> insertion,
                          Problems& problems);

}  // namespace fascicle

#endif  // FASCICLE_CORE_MUSCLE_FIBRE_FIELD_H_
