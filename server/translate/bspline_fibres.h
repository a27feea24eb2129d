#ifndef FASCICLE_SERVER_TRANSLATE_BSPLINE_FIBRES_H_
#define FASCICLE_SERVER_TRANSLATE_BSPLINE_FIBRES_H_

#include <string>
#include <vector>

#include "core/base/problems.h"
#include "core/muscle/fibre_field.h"
#include "server/translate/body_source.h"
#include "server/translate/meshes.h"
#include "server/translate/regions.h"

namespace fascicle::server {

// Fibres along a B-spline solid from a file, in the body's unit, or fitted to the mesh. If `mesh` is null, checks
// only what does not depend on it. Empty if something is wrong. Adds notes where the solid does not contain the mesh.
FibreField TranslateBsplineFibres(const BodySource& source, const std::string& path, const TranslatedTetrahedra* mesh,
                                  const NamedRegions& regions, std::vector<std::string>& notes, Problems& problems);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_TRANSLATE_BSPLINE_FIBRES_H_
