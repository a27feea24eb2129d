#include <set>

#include "core/scene/checks.h"

namespace fascicle::scene_checks {
namespace {

// What the method needs and the body has not; null: nothing.
const char* Lacking(Method method, const Body& body) {
  switch (method) {
    case Method::kVoxel:
      return body.bricks.bricks.empty() ? "there are no voxels" : nullptr;
    case Method::kEulerian:
      return body.surface.triangles.empty() ? "there is no surface" : nullptr;
    default:
      return body.mesh.tetrahedra.empty() ? "the mesh has no tetrahedra" : nullptr;
  }
}

}  // namespace

void CheckBodies(const Scene& scene, Problems& problems) {
  if (scene.bodies.empty()) problems.Add("bodies", "the scene has no body", "add at least one");
  std::set<std::string> names;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    const std::string path = IndexPath("bodies", i);
    if (const char* lacking = Lacking(scene.method, body)) problems.Add(JoinPath(path, "mesh"), lacking);
    if (!(body.density > 0))
      problems.Add(JoinPath(path, "density"), "a body needs mass", "give a density above 0 kg/m^3");
    if (!names.insert(body.name).second) {
      problems.Add(JoinPath(path, "name"), "another body is called `" + body.name + "` too",
                   "series and files are named after bodies: give each its own name");
    }
  }
}

}  // namespace fascicle::scene_checks
