#ifndef FASCICLE_SERVER_TRANSLATE_PARTS_H_
#define FASCICLE_SERVER_TRANSLATE_PARTS_H_

#include <string>

#include "core/base/problems.h"
#include "core/scene/scene.h"
#include "fascicle/v1/scene.pb.h"
#include "server/translate/meshes.h"
#include "server/translate/regions.h"
#include "server/translate/translate.h"

namespace fascicle::server {

// What differs between the parts of a body: materials, activations, where it starts. All fill in `result`, and leave it
// as it is where something is wrong. `mesh` may be nullptr: then only what does not depend on it is checked.

// region_materials and element_parameters. A tetrahedron takes the material of the last region that holds it, else that
// with its own parameters, else that of the body.
void TranslateMaterialParts(const v1::Body& body, const std::string& body_path, const TranslatedMesh* mesh,
                            const TranslatedRegions& regions, const AssetReader& assets, Body& result,
                            Problems& problems);

// activation or excitation, until `duration` [s]; region_activations and activation_scale.
void TranslateActivations(const v1::Body& body, const std::string& body_path, double duration,
                          const TranslatedMesh* mesh, const TranslatedRegions& regions, const AssetReader& assets,
                          Body& result, Problems& problems);

// initial_displacement.
void TranslateInitialDisplacement(const v1::Body& body, const std::string& body_path, const TranslatedMesh* mesh,
                                  const AssetReader& assets, Body& result, Problems& problems);

// Gives `value` to the tetrahedra of the region that is called `name`; a problem where there is no such region, or none
// in it. `parts` has one entry for each tetrahedron.
void MarkRegion(const std::string& name, const std::string& path, const TranslatedRegions& regions, std::int32_t value,
                std::vector<std::int32_t>& parts, Problems& problems);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_TRANSLATE_PARTS_H_
