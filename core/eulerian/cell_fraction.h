#ifndef FASCICLE_CORE_EULERIAN_CELL_FRACTION_H_
#define FASCICLE_CORE_EULERIAN_CELL_FRACTION_H_

#include <array>

namespace fascicle {

// The part of a cell where a function is negative, in [0, 1]: exact for one that is linear in each of the six
// tetrahedra around a diagonal, in the mean of the four diagonals. phi: at the corners, numbered as
// EulerianGrid::Corner does.
double NegativeFraction(const std::array<double, 8>& phi);

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_CELL_FRACTION_H_
