#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/scene/checks.h"

namespace fascicle::scene_checks {
namespace {

// Penetration depth of the body's rest shape, moved by its initial displacement, into a floor [m]; negative above it.
double DepthOf(const Body& body, const Floor& floor) {
  const auto* tet = std::get_if<TetShape>(&body.shape);
  double deepest = -INFINITY;
  for (std::size_t n = 0; n < body.nodes().size(); ++n) {
    Vec3 x = body.nodes()[n];
    if (tet != nullptr && n < tet->initial_displacement.size()) x += tet->initial_displacement[n];
    deepest = std::max(deepest, (floor.point - x).dot(floor.normal));
  }
  return deepest;
}

// Bodies may lie on a floor: a depth below a part of their size is round-off, or in a frame of another run the depth to
// which they have sunk into the elastic floor.
double Allowed(const Scene& scene, const Body& body) {
  double size = 0;
  for (const Vec3& x : body.nodes()) size = std::max(size, (x - body.nodes()[0]).norm());
  return (scene.start.frame ? 0.02 : 1e-9) * size;
}

}  // namespace

void CheckFloors(const Scene& scene, Problems& problems) {
  for (std::size_t k = 0; k < scene.floors.size(); ++k) {
    const Floor& floor = scene.floors[k];
    const std::string path = IndexPath("floors", k);
    if (!(std::abs(floor.normal.norm() - 1) < 1e-9) || !floor.point.allFinite()) {
      problems.Add(path, "has no finite point and unit normal");
      continue;
    }
    for (const Body& body : scene.bodies) {
      const double depth = DepthOf(body, floor);
      if (!(depth > Allowed(scene, body))) continue;
      char text[64];
      std::snprintf(text, sizeof(text), "%.3g m", depth);
      problems.Add(path, "the body `" + body.name + "` starts " + text + " inside of the floor",
                   "move the floor, or reverse its normal, which must point towards the bodies");
    }
  }
}

}  // namespace fascicle::scene_checks
