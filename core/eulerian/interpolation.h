#ifndef FASCICLE_CORE_EULERIAN_INTERPOLATION_H_
#define FASCICLE_CORE_EULERIAN_INTERPOLATION_H_

#include <optional>
#include <vector>

#include "core/eulerian/grid.h"

namespace fascicle {

// A vector at every node, valid at known nodes.
struct KnownField {
  const std::vector<Vec3>* values;
  const std::vector<std::uint8_t>* known;
};

// The value at a point: tricubic (Lagrange polynomials through four nodes along each axis) if all 64 nodes are known,
// trilinear if the eight nodes around it are, otherwise nothing.
std::optional<Vec3> Interpolate(const EulerianGrid& grid, const KnownField& field, const Vec3& point);

// The same with its derivative: column d along axis d [unit of the field per m].
struct ValueAndGradient {
  Vec3 value;
  Mat3 gradient;
};
std::optional<ValueAndGradient> InterpolateWithGradient(const EulerianGrid& grid, const KnownField& field,
                                                        const Vec3& point);

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_INTERPOLATION_H_
