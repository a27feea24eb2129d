#ifndef FASCICLE_CORE_EULERIAN_FIELDS_H_
#define FASCICLE_CORE_EULERIAN_FIELDS_H_

#include <vector>

#include "core/eulerian/cells.h"
#include "core/scene/output_fields.h"

namespace fascicle {

// A field, and the line of action that pennation_angle refers to.
struct AskedField {
  OutputField field;
  Vec3 line_of_action = Vec3::UnitX();
};

// A field at points of the body, such as the vertices of its surface, component fastest, in SI units. Velocities are
// interpolated; all others are means over the solid cells within two cells of a point, weighted by solid part and
// distance, or follow from such means. Stresses include the pressure that preserves volume.
//   now    the controls of the body at the state's time
//   cells  those of the state (UpdateCells)
std::vector<double> FieldValuesAt(const EulerianBody& body, const EulerianState& state, const BodyControls& now,
                                  const EulerianCells& cells, const AskedField& asked, const std::vector<Vec3>& points);

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_FIELDS_H_
