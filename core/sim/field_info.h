#ifndef FASCICLE_CORE_SIM_FIELD_INFO_H_
#define FASCICLE_CORE_SIM_FIELD_INFO_H_

#include <vector>

#include "core/scene/scene.h"
#include "core/sim/frame.h"

namespace fascicle {

// The values of a field, component fastest, with its name, place, number of components and unit. `element` is where
// fields of elements live.
FieldValues FieldOf(OutputField field, FieldLocation element, std::vector<double> values);

}  // namespace fascicle

#endif  // FASCICLE_CORE_SIM_FIELD_INFO_H_
