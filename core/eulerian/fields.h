#ifndef FASCICLE_CORE_EULERIAN_FIELDS_H_
#define FASCICLE_CORE_EULERIAN_FIELDS_H_

#include <vector>

#include "core/eulerian/cells.h"

namespace fascicle {

// A field at the vertices of the surface, component fastest, in SI units. Velocities are interpolated; all others are
// means over the solid cells within two cells of a vertex, weighted by solid part and distance. Stresses include the
// pressure that preserves volume.
//   now    the controls of the body at the state's time
//   cells  those of the state (UpdateCells)
std::vector<double> FieldValuesOf(const EulerianBody& body, const EulerianState& state, const BodyControls& now,
                                  const EulerianCells& cells, OutputField field);

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_FIELDS_H_
