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
  if (region.nodes.empty()) {
    problems.Add(JoinPath(path, "region"), "region `" + region.name + "` has no nodes");
  } else if (NeedsSurface(load) && region.triangles.empty() && region.quads.empty()) {
    problems.Add(JoinPath(path, "region"),
                 "the load needs surface, but region `" + region.name + "` contains no complete face of the surface",
                 "choose a larger region, one by side or by tag, or a nodal_force");
  }
}

}  // namespace

void CheckLoads(const Scene& scene, Problems& problems) {
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    for (std::size_t k = 0; k < body.loads.size(); ++k) {
      CheckLoad(body, body.loads[k], JoinPath(IndexPath("bodies", i), IndexPath("loads", k)), problems);
    }
  }
}

}  // namespace fascicle::scene_checks
