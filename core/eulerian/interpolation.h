#ifndef FASCICLE_CORE_EULERIAN_INTERPOLATION_H_
#define FASCICLE_CORE_EULERIAN_INTERPOLATION_H_

#include <optional>
#include <vector>

#include "core/eulerian/grid.h"

namespace fascicle {

// A vector at every node, some of which mean something.
struct KnownField {
  const std::vector<Vec3>* values;
  const std::vector<std::uint8_t>* known;
};

// The value at a point: tricubic (Lagrange's polynomials through four nodes along each axis) where all 64 nodes are
// known, trilinear where the eight around it are, else nothing.
std::optional<Vec3> Interpolate(const EulerianGrid& grid, const KnownField& field, const Vec3& point);

// The same with its derivative: column d along axis d [1/m of the field's unit].
struct ValueAndGradient {
  Vec3 value;
  Mat3 gradient;
};
std::optional<ValueAndGradient> InterpolateWithGradient(const EulerianGrid& grid, const KnownField& field,
                                                        const Vec3& point);

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_INTERPOLATION_H_
