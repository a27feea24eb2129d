#include "server/translate/curves.h"
#include "server/translate/supports_and_loads.h"
#include "server/translate/values.h"

namespace fascicle::server {

std::vector<Squeeze> TranslateSqueezes(const v1::Scene& scene, Problems& problems) {
  std::vector<Squeeze> squeezes;
  for (int i = 0; i < scene.squeezes_size(); ++i) {
    const v1::Squeeze& wire = scene.squeezes(i);
    const std::string path = IndexPath("squeezes", static_cast<std::size_t>(i));
    Squeeze squeeze;
    squeeze.point = ToVec3(wire.point());
    squeeze.normal = ToDirection(wire.normal(), JoinPath(path, "normal"), problems);
    if (wire.has_scale()) {
      squeeze.scale = TranslateCurve(wire.scale(), kFactorCurve, JoinPath(path, "scale"), problems);
    }
    if (ObeysRules(wire)) {
      squeeze.force_density = wire.force_density();
      squeeze.width = wire.width();
    }
    squeezes.push_back(std::move(squeeze));
  }
  return squeezes;
}

}  // namespace fascicle::server
