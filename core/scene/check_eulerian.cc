#include <algorithm>
#include <cmath>

#include "core/scene/checks.h"

namespace fascicle::scene_checks {
namespace {

bool DependsOnSpeed(const Material& material) {
  return std::visit(
      [](const auto& law) {
        if constexpr (requires { law.DependsOnRate(); }) {
          return law.DependsOnRate();
        } else {
          return false;
        }
      },
      material);
}

void CheckPlasticity(const Plasticity& plasticity, const std::string& path, Problems& problems) {
  if (!(plasticity.yield_stress > 0)) {
    problems.Add(JoinPath(path, "yield_stress"), "must be above 0 Pa", "omit plasticity for an elastic body");
  }
  if (!(plasticity.relaxation_time >= 0 && std::isfinite(plasticity.relaxation_time))) {
    problems.Add(JoinPath(path, "relaxation_time"), "must be a finite time of at least 0 s");
  }
}

void CheckForceField(const PlaneForceField& field, const std::string& path, Problems& problems) {
  if (!(std::abs(field.normal.norm() - 1) < 1e-9) || !field.point.allFinite()) {
    problems.Add(path, "has no finite point and unit normal");
  }
  if (!std::isfinite(field.force_density)) problems.Add(JoinPath(path, "force_density"), "must be finite");
  if (!(field.width >= 0 && std::isfinite(field.width))) {
    problems.Add(JoinPath(path, "width"), "must be a finite length of at least 0 m");
  }
}

// Regions are parts of the material here, which the tags of a mesh file do not define.
void CheckPlace(const Body& body, std::int32_t region, const std::string& path, Problems& problems) {
  if (region < 0 || region >= static_cast<std::int32_t>(body.regions.size())) return;
  const std::vector<Selector>& selectors = body.regions[region].selectors;
  if (std::any_of(selectors.begin(), selectors.end(),
                  [](const Selector& s) { return std::holds_alternative<TagSelector>(s); })) {
    problems.Add(JoinPath(path, "region"), "a tag does not define which material points are meant",
                 "select the region by plane, box, sphere or side");
  }
}

void CheckEulerianBody(const Body& body, const std::string& path, Problems& problems) {
  if (const std::optional<Plasticity>& plasticity = body.surface().plasticity) {
    CheckPlasticity(*plasticity, JoinPath(path, "plasticity"), problems);
  }
  if (body.damping.stiffness_proportional != 0 || body.damping.viscosity != 0) {
    problems.Add(JoinPath(path, "damping"), "the eulerian method has mass-proportional damping only",
                 "use mass_proportional only");
  }
  RefuseViscoelasticity(body, "eulerian", path, problems);
  if (DependsOnSpeed(body.material)) {
    problems.Add(JoinPath(path, "material"), "the eulerian method does not support the rate of fibres",
                 "omit max_velocity, or use the tet method");
  }
  for (std::size_t k = 0; k < body.constraints.size(); ++k) {
    const Constraint& constraint = body.constraints[k];
    const std::string where = JoinPath(path, IndexPath("constraints", k));
    if (!std::all_of(constraint.axes.begin(), constraint.axes.end(), [](bool held) { return held; })) {
      problems.Add(JoinPath(where, "axes"), "supports of the eulerian method prescribe all three axes",
                   "omit the axes, or use the tet method");
    }
    CheckPlace(body, constraint.region, where, problems);
  }
  for (std::size_t k = 0; k < body.loads.size(); ++k) {
    CheckPlace(body, body.loads[k].region, JoinPath(path, IndexPath("loads", k)), problems);
  }
}

}  // namespace

void CheckEulerian(const Scene& scene, Problems& problems) {
  if (scene.method != Method::kEulerian) {
    if (scene.squeezes.empty()) return;
    problems.Add("squeezes", "only the eulerian method supports them",
                 "put loads on regions, or use the eulerian method");
    return;
  }
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    if (!std::holds_alternative<SurfaceShape>(scene.bodies[i].shape)) continue;
    CheckEulerianBody(scene.bodies[i], IndexPath("bodies", i), problems);
  }
  RefuseRigidBodies(scene, "eulerian", problems);
  for (std::size_t k = 0; k < scene.squeezes.size(); ++k) {
    CheckForceField(scene.squeezes[k], IndexPath("squeezes", k), problems);
  }
}

}  // namespace fascicle::scene_checks
