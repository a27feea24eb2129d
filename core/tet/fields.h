#ifndef FASCICLE_CORE_TET_FIELDS_H_
#define FASCICLE_CORE_TET_FIELDS_H_

#include <vector>

#include "core/tet/forces.h"
#include "core/tet/state.h"

namespace fascicle {

// Values of a field at the mesh nodes (velocity) or elements (all others: averaged over quadrature points) of one body,
// component fastest (stresses xx yy zz xy yz xz), as in scene.proto Field. Stresses include the elastic and active
// parts, not the viscous one.
std::vector<double> FieldValuesOf(const TetModel& model, std::size_t body, OutputField field, const FibreDrive& drive,
                                  const TetState& state, ThreadTeam& team);

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_FIELDS_H_
