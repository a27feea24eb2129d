#include "server/translate/curves.h"
#include "server/translate/supports_and_loads.h"
#include "server/translate/values.h"

namespace fascicle::server {

std::vector<Load> TranslateLoads(const v1::Body& body, const std::string& body_path, const Names& regions,
                                 Problems& problems) {
  std::vector<Load> result;
  for (int i = 0; i < body.loads_size(); ++i) {
    const v1::Load& load = body.loads(i);
    const std::string path = JoinPath(body_path, IndexPath("loads", static_cast<std::size_t>(i)));
    Load translated;
    const auto region = regions.Find(load.region(), JoinPath(path, "region"), problems);
    if (load.has_traction()) {
      translated.kind = Traction{ToVec3(load.traction().vector())};
    } else {
      translated.kind = NodalForce{ToVec3(load.nodal_force().total())};
    }
    if (load.has_scale())
      translated.scale = TranslateCurve(load.scale(), kFactorCurve, JoinPath(path, "scale"), problems);
    if (!region) continue;
    translated.region = static_cast<std::int32_t>(*region);
    result.push_back(std::move(translated));
  }
  return result;
}

Gravity TranslateGravity(const v1::Scene& scene, Problems& problems) {
  Gravity gravity;
  if (!scene.has_gravity()) return gravity;
  if (ObeysRules(scene.gravity())) gravity.acceleration = ToVec3(scene.gravity().acceleration());
  if (scene.gravity().has_scale()) {
    gravity.scale = TranslateCurve(scene.gravity().scale(), kFactorCurve, "gravity.scale", problems);
  }
  return gravity;
}

}  // namespace fascicle::server
