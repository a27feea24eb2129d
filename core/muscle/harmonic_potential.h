#ifndef FASCICLE_CORE_MUSCLE_HARMONIC_POTENTIAL_H_
#define FASCICLE_CORE_MUSCLE_HARMONIC_POTENTIAL_H_

#include <cstdint>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "core/base/problems.h"
#include "core/muscle/fibre_field.h"

namespace fascicle {

// The harmonic potential between a muscle's two attachments.
struct HarmonicPotential {
  std::vector<double> values;  // at the nodes: exactly 0 on the origin, exactly 1 on the insertion
  FibreField directions;       // of the gradient in each tetrahedron, like HarmonicFibres
};

// Returns nothing and adds the problems listed at HarmonicFibres if there is no such potential. Throws Stopped after a
// stop request.
std::optional<HarmonicPotential> SolveHarmonicPotential(const TetMesh& mesh, std::span<const std::int32_t> origin,
                                                        std::span<const std::int32_t> insertion, Problems& problems,
                                                        const std::stop_token& stop);

}  // namespace fascicle

#endif  // FASCICLE_CORE_MUSCLE_HARMONIC_POTENTIAL_H_
