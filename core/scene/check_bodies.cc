#include <set>
#include <utility>

#include "core/scene/checks.h"

namespace fascicle::scene_checks {
namespace {

// What a body of the method needs and this one lacks; null: nothing.
const char* Lacking(Method method, const Shape& shape) {
  switch (method) {
    case Method::kTet: {
      const auto* tet = std::get_if<TetShape>(&shape);
      return tet == nullptr || tet->mesh.tetrahedra.empty() ? "the mesh has no tetrahedra" : nullptr;
    }
    case Method::kVoxel: {
      const auto* bricks = std::get_if<VoxelShape>(&shape);
      return bricks == nullptr || bricks->mesh.bricks.empty() ? "there are no voxels" : nullptr;
    }
    case Method::kEulerian: {
      const auto* surface = std::get_if<SurfaceShape>(&shape);
      return surface == nullptr || surface->mesh.triangles.empty() ? "there is no surface" : nullptr;
    }
  }
  return nullptr;
}

}  // namespace

void CheckBodies(const Scene& scene, Problems& problems) {
  if (scene.bodies.empty() && !scene.skeleton) problems.Add("bodies", "the scene has no body", "add at least one");
  if (scene.bodies.empty()) {
    for (const auto& [is_empty, path] : {std::pair(scene.floors.empty(), "floors"),
                                         {scene.rigid_bodies.empty(), "rigid_bodies"},
                                         {scene.contacts.empty(), "contacts"}}) {
      if (!is_empty) problems.Add(path, "no body can touch them", "remove them, or add a body");
    }
  }
  std::set<std::string> names;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    const std::string path = IndexPath("bodies", i);
    if (const char* lacking = Lacking(scene.method, body.shape)) problems.Add(JoinPath(path, "mesh"), lacking);
    if (!(body.density > 0))
      problems.Add(JoinPath(path, "density"), "a body needs mass", "give a density above 0 kg/m^3");
    if (!names.insert(body.name).second) {
      problems.Add(JoinPath(path, "name"), "another body is called `" + body.name + "`",
                   "series and files are named after bodies: give each a unique name");
    }
  }
}

}  // namespace fascicle::scene_checks
