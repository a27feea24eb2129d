#include <utility>

#include "server/translate/meshes.h"
#include "server/translate/parts.h"
#include "server/translate/shapes.h"

namespace fascicle::server {

bool TranslateVoxelShape(const BodySource& source, const RegionSelectors& selectors, Body& body, Problems& structure,
                         Problems& others) {
  RefuseFields(source, {"fibres"}, "voxels have no fibres", "omit them, or use the tet method", others);
  RefuseFields(source, {"region_activations", "activation_scale"}, "voxels don't contract",
               "apply the muscle's force as a load on a region, or use the tet method", others);
  RefuseFields(source, {"initial_displacement", "initial_velocity"}, "voxels start from rest",
               "use start_loaded to start in equilibrium with loads", others);
  RefuseFields(source, {"plasticity"}, "only the eulerian method supports plastic flow",
               "omit it, or use the eulerian method", others);
  auto bricks = TranslateBricks(source, body.notes, structure);
  std::optional<std::size_t> elements;
  if (bricks) {
    elements = bricks->bricks.size();
    body.regions = SelectRegions(selectors, *bricks, source.tools.stop);
    CheckRegions(source.wire, source.path, selectors, body.regions, *bricks, structure);
  } else {
    body.regions = EmptyRegions(selectors);
  }
  VoxelShape shape;
  shape.materials = TranslateMaterialParts(source, elements, {selectors.names, body.regions}, others);
  for (int i = 0; i < source.wire.region_materials_size(); ++i) {
    if (!source.wire.region_materials(i).material().has_viscoelasticity()) continue;
    const std::string part = JoinPath(source.path, IndexPath("region_materials", static_cast<std::size_t>(i)));
    others.Add(JoinPath(part, "material.viscoelasticity"), "the voxel method has no viscoelastic materials",
               "omit it, or use the tet method");
  }
  if (bricks) shape.mesh = std::move(*bricks);
  body.shape = std::move(shape);
  return elements.has_value();
}

}  // namespace fascicle::server
