#include <algorithm>

#include "core/scene/checks.h"
#include "core/scene/nodal_forces.h"

namespace fascicle::scene_checks {
namespace {

void CheckLoad(const Body& body, const Load& load, const std::string& path, Problems& problems) {
  if (load.region < 0 || load.region >= static_cast<std::int32_t>(body.regions.size())) {
    problems.Add(JoinPath(path, "region"), "there is no such region");
    return;
  }
  const Region& region = body.regions[load.region];
  const LoadedPart part = LoadedPartOf(load);
  if (region.nodes.empty()) {
    problems.Add(JoinPath(path, "region"), "region `" + region.name + "` has no nodes");
  } else if (part == LoadedPart::kElements && region.elements.empty()) {
    problems.Add(JoinPath(path, "region"), "the load needs elements, but region `" + region.name + "` contains none",
                 "choose a region by plane, box or sphere, which take elements with their centroid inside, by side "
                 "with a depth, or by a tag of elements");
  } else if (part == LoadedPart::kFaces && region.triangles.empty() && region.quads.empty()) {
    problems.Add(JoinPath(path, "region"),
                 "the load needs surface, but region `" + region.name + "` contains no complete face of the surface",
                 "choose a larger region, one by side or by tag, or a nodal_force");
  }
}

void CheckSprings(const Load& load, const std::string& path, Problems& problems) {
  const auto* springs = std::get_if<Springs>(&load.kind);
  if (springs == nullptr) return;
  if (springs->stiffness.minCoeff() < 0 || springs->stiffness.isZero()) {
    problems.Add(JoinPath(path, "springs.stiffness"), "needs values of at least 0 N/m, and one above",
                 "0 for the axes without springs");
  }
  if (*std::min_element(load.scale.values.begin(), load.scale.values.end()) < 0) {
    problems.Add(JoinPath(path, "scale"), "a spring of negative stiffness pushes nodes away without end",
                 "values of at least 0");
  }
}

// What the scene's method can't do.
void CheckMethod(Method method, const Load& load, const std::string& path, Problems& problems) {
  if (method == Method::kVoxel && std::holds_alternative<Springs>(load.kind)) {
    problems.Add(JoinPath(path, "springs"), "the voxel method has no springs", "use the tet method");
  }
  if (method != Method::kEulerian) return;
  const char* kind = std::holds_alternative<Pressure>(load.kind)    ? "pressure"
                     : std::holds_alternative<BodyForce>(load.kind) ? "body_force"
                     : std::holds_alternative<Springs>(load.kind)   ? "springs"
                                                                    : nullptr;
  if (kind == nullptr) return;
  problems.Add(JoinPath(path, kind), "the eulerian method has tractions, nodal forces and gravity only",
               "use one of these, or the tet method");
}

}  // namespace

void CheckLoads(const Scene& scene, Problems& problems) {
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    for (std::size_t k = 0; k < body.loads.size(); ++k) {
      const std::string path = JoinPath(IndexPath("bodies", i), IndexPath("loads", k));
      CheckLoad(body, body.loads[k], path, problems);
      CheckSprings(body.loads[k], path, problems);
      CheckMethod(scene.method, body.loads[k], path, problems);
    }
  }
}

}  // namespace fascicle::scene_checks
