#ifndef FASCICLE_SERVER_TRANSLATE_FIBRES_H_
#define FASCICLE_SERVER_TRANSLATE_FIBRES_H_

#include <string>
#include <vector>

#include "core/base/problems.h"
#include "core/muscle/fibre_field.h"
#include "server/translate/body_source.h"
#include "server/translate/meshes.h"
#include "server/translate/regions.h"

namespace fascicle::server {

// The fibres of tetrahedra; empty if the body has none. If `mesh` is null, checks only what does not depend on it. A
// constant field replaces invalid fibres in later checks. Adds remarks to `notes`.
FibreField TranslateFibres(const BodySource& source, const TranslatedTetrahedra* mesh, const NamedRegions& regions,
                           std::vector<std::string>& notes, Problems& problems);

// Adds a problem if a law of the body needs fibres and none are given.
void CheckFibresAreGiven(const BodySource& source, Problems& problems);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_TRANSLATE_FIBRES_H_
