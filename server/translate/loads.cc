#include "server/translate/curves.h"
#include "server/translate/supports_and_loads.h"
#include "server/translate/values.h"

namespace fascicle::server {

namespace {

// A unit force, scaled by the muscle's pull [N].
void TranslateStern(const v1::Load& wire_load, const std::string& load_path, Load& load, Problems& problems) {
  const v1::SternForce& wire = wire_load.stern();
  const std::string path = JoinPath(load_path, "stern");
  if (wire_load.has_scale()) {
    problems.Add(JoinPath(load_path, "scale"), "is given beside a muscle's force", "change its activation instead");
  }
  load.kind = NodalForce{ToDirection(wire.direction(), JoinPath(path, "direction"), problems)};
  SternPull& pull = load.stern.emplace();
  if (wire.has_angle()) {
    pull.drive.angle = TranslateCurve(wire.angle(), kJointAngleCurve, JoinPath(path, "angle"), problems);
  } else {
    problems.Add(JoinPath(path, "angle"), "is missing", "give times [s] and values [rad]");
  }
  if (wire.has_activation()) {
    pull.drive.activation = TranslateCurve(wire.activation(), kActivationCurve, JoinPath(path, "activation"), problems);
  }
  pull.muscle = {wire.origin_distance(),      wire.insertion_distance(), wire.peak_force(), wire.optimal_angle(),
                 wire.contractile_fraction(), wire.hill_curvature(),     wire.hill_rate(),  wire.eccentric_force()};
}

}  // namespace

std::vector<Load> TranslateLoads(const v1::Body& body, const std::string& body_path, const Names& regions,
                                 Problems& problems) {
  std::vector<Load> result;
  for (int i = 0; i < body.loads_size(); ++i) {
    const v1::Load& load = body.loads(i);
    const std::string path = JoinPath(body_path, IndexPath("loads", static_cast<std::size_t>(i)));
    Load translated;
    const auto region = regions.Find(load.region(), JoinPath(path, "region"), problems);
    if (load.has_scale()) {
      translated.scale = TranslateCurve(load.scale(), kFactorCurve, JoinPath(path, "scale"), problems);
    }
    switch (load.kind_case()) {
      case v1::Load::kTraction:
        translated.kind = Traction{ToVec3(load.traction().vector())};
        break;
      case v1::Load::kNodalForce:
        translated.kind = NodalForce{ToVec3(load.nodal_force().total())};
        break;
      case v1::Load::kStern:
        TranslateStern(load, path, translated, problems);
        break;
      case v1::Load::kPressure:
        translated.kind = Pressure{load.pressure().value()};
        break;
      case v1::Load::kBodyForce:
        translated.kind = BodyForce{ToVec3(load.body_force().density())};
        break;
      case v1::Load::kSprings:
        translated.kind = Springs{ToVec3(load.springs().stiffness())};
        break;
      case v1::Load::kLineSpring: {
        LineSpring spring;
        spring.stiffness = load.line_spring().stiffness();
        if (load.line_spring().has_rest_length()) spring.rest_length = load.line_spring().rest_length();
        spring.tension_only = load.line_spring().tension_only();
        translated.kind = spring;
        break;
      }
      case v1::Load::KIND_NOT_SET:
        break;  // reported by the rules
    }
    if (!region) continue;
    translated.region = static_cast<std::int32_t>(*region);
    result.push_back(std::move(translated));
  }
  return result;
}

void FindEndsOfLineSprings(const v1::Scene& scene, const Names& body_names, std::vector<Body>& bodies,
                           Problems& problems) {
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const v1::Body& wire = scene.bodies(static_cast<int>(b));
    // Without problems, loads correspond to those of the message. Otherwise the scene is not used.
    const bool correspond = bodies[b].loads.size() == static_cast<std::size_t>(wire.loads_size());
    for (int k = 0; k < wire.loads_size(); ++k) {
      if (!wire.loads(k).has_line_spring()) continue;
      const v1::LineSpring& spring = wire.loads(k).line_spring();
      const std::string path =
          JoinPath(JoinPath(IndexPath("bodies", b), IndexPath("loads", static_cast<std::size_t>(k))), "line_spring");
      std::optional<std::size_t> other = b;
      if (!spring.body().empty()) other = body_names.Find(spring.body(), JoinPath(path, "body"), problems);
      if (!other) continue;
      Names regions("region");
      Problems reported;  // malformed names are reported with the body
      for (const Region& region : bodies[*other].regions) regions.Add(region.name, "", reported);
      const auto region = regions.Find(spring.region(), JoinPath(path, "region"), problems);
      if (!region || !correspond) continue;
      auto& translated = std::get<LineSpring>(bodies[b].loads[static_cast<std::size_t>(k)].kind);
      translated.body = static_cast<std::int32_t>(*other);
      translated.region = static_cast<std::int32_t>(*region);
    }
  }
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
