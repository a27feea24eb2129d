#include "core/scene/check_parts.h"
#include "core/scene/checks.h"

namespace fascicle::scene_checks {
namespace {

void CheckShape(const TetShape& shape, const std::string& path, Problems& problems) {
  CheckParts(shape.materials, ElementCount(shape.mesh), path, problems);
}

void CheckShape(const VoxelShape& shape, const std::string& path, Problems& problems) {
  CheckParts(shape.materials, shape.mesh.bricks.size(), path, problems);
}

void CheckShape(const SurfaceShape&, const std::string&, Problems&) {}

}  // namespace

void CheckMaterials(const Scene& scene, Problems& problems) {
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const std::string path = JoinPath(IndexPath("bodies", i), "region_materials");
    std::visit([&](const auto& shape) { CheckShape(shape, path, problems); }, scene.bodies[i].shape);
  }
}

}  // namespace fascicle::scene_checks
