#include <utility>

#include "server/translate/fibres.h"
#include "server/translate/meshes.h"
#include "server/translate/parts.h"
#include "server/translate/shapes.h"

namespace fascicle::server {

bool TranslateTetShape(const BodySource& source, const RegionSelectors& selectors, Body& body, Problems& structure,
                       Problems& others) {
  RefuseFields(source, {"plasticity"}, "only the eulerian method supports plastic flow",
               "omit it, or use the eulerian method", others);
  auto tetrahedra = TranslateTetrahedra(source, Method::kTet, body.notes, structure);
  std::optional<std::size_t> elements;
  if (tetrahedra) {
    elements = ElementCount(tetrahedra->mesh);
    body.regions = SelectRegions(selectors, tetrahedra->mesh, source.tools.stop);
    CheckRegions(source.wire, source.path, selectors, body.regions, tetrahedra->mesh, structure);
  } else {
    body.regions = EmptyRegions(selectors);
  }
  const NamedRegions regions = {selectors.names, body.regions};
  TetShape shape;
  shape.fibres = TranslateFibres(source, tetrahedra ? &*tetrahedra : nullptr, regions, body.notes, others);
  shape.prestretch = TranslatePrestretch(source, elements, others);
  shape.materials = TranslateMaterialParts(source, elements, regions, others);
  shape.viscoelasticity = TranslatePartViscoelasticity(source, shape.materials.more.size(), others);
  shape.activations = TranslateActivationParts(source, elements, regions, others);
  shape.activation_scale = TranslateActivationScale(source, elements, others);
  TranslateInitialState(source, tetrahedra ? &*tetrahedra : nullptr, shape, body.notes, others);
  if (tetrahedra) shape.mesh = std::move(tetrahedra->mesh);
  body.shape = std::move(shape);
  return elements.has_value();
}

}  // namespace fascicle::server
