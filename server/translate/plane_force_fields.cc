#include "server/translate/curves.h"
#include "server/translate/supports_and_loads.h"
#include "server/translate/values.h"

namespace fascicle::server {

std::vector<PlaneForceField> TranslatePlaneForceFields(const v1::Scene& scene, Problems& problems) {
  std::vector<PlaneForceField> fields;
  for (int i = 0; i < scene.squeezes_size(); ++i) {
    const v1::Squeeze& wire = scene.squeezes(i);
    const std::string path = IndexPath("squeezes", static_cast<std::size_t>(i));
    PlaneForceField field;
    field.point = ToVec3(wire.point());
    field.normal = ToDirection(wire.normal(), JoinPath(path, "normal"), problems);
    if (wire.has_scale()) {
      field.scale = TranslateCurve(wire.scale(), kFactorCurve, JoinPath(path, "scale"), problems);
    }
    if (ObeysRules(wire)) {
      field.force_density = wire.force_density();
      field.width = wire.width();
    }
    fields.push_back(std::move(field));
  }
  return fields;
}

}  // namespace fascicle::server
