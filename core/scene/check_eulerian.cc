#include <algorithm>

#include "core/scene/checks.h"

namespace fascicle::scene_checks {
namespace {

bool DependsOnSpeed(const Material& material) {
  const auto* muscle = std::get_if<Muscle>(&material);
  return muscle != nullptr && muscle->DependsOnRate();
}

void CheckParts(const Body& body, const std::string& path, Problems& problems) {
  if (!body.more_materials.empty()) {
    problems.Add(JoinPath(path, "region_materials"), "a body of the eulerian method has one material",
                 "leave out region_materials and element_parameters, or use the tet method");
  }
  if (!body.more_activations.empty() || !body.activation_scale.empty()) {
    problems.Add(JoinPath(path, "region_activations"), "a body of the eulerian method has one activation",
                 "leave out region_activations and activation_scale, or use the tet method");
  }
  if (!body.initial_displacement.empty()) {
    problems.Add(JoinPath(path, "initial_displacement"), "bodies of the eulerian method start from rest",
                 "leave it out, or use the tet method");
  }
}

// Regions are places in the material here: a tag of the mesh file tells none.
void CheckPlace(const Body& body, std::int32_t region, const std::string& path, Problems& problems) {
  if (region < 0 || region >= static_cast<std::int32_t>(body.regions.size())) return;
  const std::vector<Selector>& selectors = body.regions[region].selectors;
  if (std::any_of(selectors.begin(), selectors.end(),
                  [](const Selector& s) { return std::holds_alternative<TagSelector>(s); })) {
    problems.Add(JoinPath(path, "region"), "a tag does not tell which points of the material are meant",
                 "select the region by plane, box, sphere or side");
  }
}

void CheckBody(const Body& body, const std::string& path, Problems& problems) {
  CheckParts(body, path, problems);
  if (body.damping.stiffness_proportional != 0 || body.damping.viscosity != 0) {
    problems.Add(JoinPath(path, "damping"), "the eulerian method damps in proportion to mass only",
                 "give mass_proportional alone");
  }
  if (DependsOnSpeed(body.material)) {
    problems.Add(JoinPath(path, "material"), "the eulerian method does not know how fast fibres shorten",
                 "leave max_velocity at 0, or use the tet method");
  }
  for (std::size_t k = 0; k < body.constraints.size(); ++k) {
    const Constraint& constraint = body.constraints[k];
    const std::string where = JoinPath(path, IndexPath("constraints", k));
    if (!std::all_of(constraint.axes.begin(), constraint.axes.end(), [](bool held) { return held; })) {
      problems.Add(JoinPath(where, "axes"), "supports of the eulerian method hold all three axes",
                   "leave the axes out, or use the tet method");
    }
    CheckPlace(body, constraint.region, where, problems);
  }
  for (std::size_t k = 0; k < body.loads.size(); ++k) {
    CheckPlace(body, body.loads[k].region, JoinPath(path, IndexPath("loads", k)), problems);
  }
}

}  // namespace

void CheckEulerian(const Scene& scene, Problems& problems) {
  const bool eulerian = scene.method == Method::kEulerian;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const std::string path = IndexPath("bodies", i);
    if (eulerian) {
      CheckBody(scene.bodies[i], path, problems);
    } else if (scene.bodies[i].plasticity) {
      problems.Add(JoinPath(path, "plasticity"), "only the eulerian method knows plastic flow",
                   "leave it out, or use the eulerian method");
    }
  }
  if (eulerian && !scene.floors.empty()) {
    problems.Add("floors", "the eulerian method does not know floors yet", "leave them out, or use the tet method");
  }
  if (!eulerian && !scene.squeezes.empty()) {
    problems.Add("squeezes", "only the eulerian method knows them", "put loads on regions, or use the eulerian method");
  }
}

}  // namespace fascicle::scene_checks
