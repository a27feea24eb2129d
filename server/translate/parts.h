#ifndef FASCICLE_SERVER_TRANSLATE_PARTS_H_
#define FASCICLE_SERVER_TRANSLATE_PARTS_H_

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/base/problems.h"
#include "core/scene/shape.h"
#include "server/translate/body_source.h"
#include "server/translate/meshes.h"
#include "server/translate/regions.h"

namespace fascicle::server {

// Data of the parts of a body: materials, activations, initial states. Empty if something is wrong.
//   elements  their number in the mesh; if absent, only what does not depend on the mesh is checked

// region_materials and element_parameters. An element has the material of the last region that contains it, otherwise
// the one with its own parameters, otherwise that of the body.
Parts<Material> TranslateMaterialParts(const BodySource& source, std::optional<std::size_t> elements,
                                       const NamedRegions& regions, Problems& problems);

// viscoelasticity of the materials of region_materials and element_parameters, `parts` of them in the order of
// TranslateMaterialParts; empty if all are elastic.
std::vector<PronySeries> TranslatePartViscoelasticity(const BodySource& source, std::size_t parts, Problems& problems);

// activation and excitation of the whole body.
Curve TranslateActivation(const BodySource& source, Problems& problems);
std::optional<Excitation> TranslateExcitation(const BodySource& source, Problems& problems);

// region_activations.
Parts<Curve> TranslateActivationParts(const BodySource& source, std::optional<std::size_t> elements,
                                      const NamedRegions& regions, Problems& problems);

// activation_scale.
std::vector<double> TranslateActivationScale(const BodySource& source, std::optional<std::size_t> elements,
                                             Problems& problems);

// fibres.prestretch and prestretch_file, one value for each element; empty: 1.
std::vector<double> TranslatePrestretch(const BodySource& source, std::optional<std::size_t> elements,
                                        Problems& problems);

// initial_displacement and initial_velocity. Adds to `notes` if mid-edge nodes are interpolated, or ignored. `mesh` may
// be null.
void TranslateInitialState(const BodySource& source, const TranslatedTetrahedra* mesh, TetShape& shape,
                           std::vector<std::string>& notes, Problems& problems);

// Assigns `value` to the elements of region `name`; a problem if there is no such region or it contains no element.
// `parts` has one entry for each element.
void MarkRegion(const std::string& name, const std::string& path, const NamedRegions& regions, std::int32_t value,
                std::vector<std::int32_t>& parts, Problems& problems);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_TRANSLATE_PARTS_H_
