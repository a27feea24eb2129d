#include "core/sim/field_info.h"

#include <utility>

namespace fascicle {

FieldValues FieldOf(OutputField field, FieldLocation element, std::vector<double> values) {
  switch (field) {
    case OutputField::kVelocity:
      return {"velocity", FieldLocation::kNode, 3, "m/s", std::move(values)};
    case OutputField::kCauchyStress:
      return {"cauchy_stress", element, 6, "Pa", std::move(values)};
    case OutputField::kVonMisesStress:
      return {"von_mises_stress", element, 1, "Pa", std::move(values)};
    case OutputField::kPressure:
      return {"pressure", element, 1, "Pa", std::move(values)};
    case OutputField::kVolumeRatio:
      return {"volume_ratio", element, 1, "1", std::move(values)};
    case OutputField::kFibreStretch:
      return {"fibre_stretch", element, 1, "1", std::move(values)};
    case OutputField::kFibreDirection:
      return {"fibre_direction", element, 3, "1", std::move(values)};
  }
  return {};
}

}  // namespace fascicle
