#include <set>

#include "core/scene/checks.h"

namespace fascicle::scene_checks {

void CheckBodies(const Scene& scene, Problems& problems) {
  if (scene.bodies.empty()) problems.Add("bodies", "the scene has no body", "add at least one");
  std::set<std::string> names;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    const std::string path = IndexPath("bodies", i);
    const bool voxels = scene.method == Method::kVoxel;
    if (voxels ? body.bricks.bricks.empty() : body.mesh.tetrahedra.empty()) {
      problems.Add(JoinPath(path, "mesh"), voxels ? "there are no voxels" : "the mesh has no tetrahedra");
    }
    if (!(body.density > 0))
      problems.Add(JoinPath(path, "density"), "a body needs mass", "give a density above 0 kg/m^3");
    if (!names.insert(body.name).second) {
      problems.Add(JoinPath(path, "name"), "another body is called `" + body.name + "` too",
                   "series and files are named after bodies: give each its own name");
    }
  }
}

}  // namespace fascicle::scene_checks
