#ifndef FASCICLE_CORE_MUSCLE_FILL_FIBRES_H_
#define FASCICLE_CORE_MUSCLE_FILL_FIBRES_H_

#include <cstddef>
#include <stop_token>

#include "core/muscle/fibre_field.h"

namespace fascicle {

// Gives tetrahedra without a direction (zero) the mean of their face neighbours' directions, layer by layer. Returns
// the number of tetrahedra that remain without one. Throws Stopped after a stop request.
std::size_t FillFromNeighbours(const TetMesh& mesh, const std::stop_token& stop, FibreField& fibres);

}  // namespace fascicle

#endif  // FASCICLE_CORE_MUSCLE_FILL_FIBRES_H_
