#ifndef FASCICLE_SERVER_TRANSLATE_PARTS_H_
#define FASCICLE_SERVER_TRANSLATE_PARTS_H_

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/base/problems.h"
#include "core/scene/shape.h"
#include "server/translate/body_source.h"
#include "server/translate/regions.h"

namespace fascicle::server {

// What differs between the parts of a body: materials, activations, where it starts. Empty where something is wrong.
//   elements, nodes  of the mesh; without one, only what does not depend on it is checked

// region_materials and element_parameters. An element takes the material of the last region that holds it, else that
// with its own parameters, else that of the body.
Parts<Material> TranslateMaterialParts(const BodySource& source, std::optional<std::size_t> elements,
                                       const NamedRegions& regions, Problems& problems);

// activation or excitation of the whole body, until the scene's end.
Curve TranslateActivation(const BodySource& source, Problems& problems);

// region_activations.
Parts<Curve> TranslateActivationParts(const BodySource& source, std::optional<std::size_t> elements,
                                      const NamedRegions& regions, Problems& problems);

// activation_scale.
std::vector<double> TranslateActivationScale(const BodySource& source, std::optional<std::size_t> elements,
                                             Problems& problems);

// initial_displacement [m].
std::vector<Vec3> TranslateInitialDisplacement(const BodySource& source, std::optional<std::size_t> nodes,
                                               Problems& problems);

// Gives `value` to the elements of the region that is called `name`; a problem where there is no such region, or no
// element in it. `parts` has one entry for each element.
void MarkRegion(const std::string& name, const std::string& path, const NamedRegions& regions, std::int32_t value,
                std::vector<std::int32_t>& parts, Problems& problems);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_TRANSLATE_PARTS_H_
