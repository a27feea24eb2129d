#ifndef FASCICLE_SERVER_TRANSLATE_FIBRES_H_
#define FASCICLE_SERVER_TRANSLATE_FIBRES_H_

#include <string>
#include <vector>

#include "core/base/problems.h"
#include "core/muscle/fibre_field.h"
#include "fascicle/v1/scene.pb.h"
#include "server/translate/meshes.h"
#include "server/translate/regions.h"
#include "server/translate/translate.h"

namespace fascicle::server {

// The fibres of a body; empty when it has none. `mesh` may be nullptr: then only what does not depend on it is checked.
// Where something is wrong a constant field stands in for later checks. Adds to `notes` what is noteworthy.
FibreField TranslateFibres(const v1::Body& body, const std::string& body_path, const TranslatedMesh* mesh,
                           const TranslatedRegions& regions, const AssetReader& assets, std::vector<std::string>& notes,
                           Problems& problems);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_TRANSLATE_FIBRES_H_
