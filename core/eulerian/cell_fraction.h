#ifndef FASCICLE_CORE_EULERIAN_CELL_FRACTION_H_
#define FASCICLE_CORE_EULERIAN_CELL_FRACTION_H_

#include <array>

namespace fascicle {

// The part of a cell where a function is negative, in [0, 1]: exact for a function that is linear in each of the six
// tetrahedra around a diagonal; averaged over the four diagonals. phi: values at the corners, in the order of
// EulerianGrid::Corner.
double NegativeFraction(const std::array<double, 8>& phi);

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_CELL_FRACTION_H_
