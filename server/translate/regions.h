#ifndef FASCICLE_SERVER_TRANSLATE_REGIONS_H_
#define FASCICLE_SERVER_TRANSLATE_REGIONS_H_

#include <string>
#include <vector>

#include "core/base/problems.h"
#include "core/geometry/region.h"
#include "fascicle/v1/scene.pb.h"
#include "server/translate/meshes.h"
#include "server/translate/names.h"

namespace fascicle::server {

struct TranslatedRegions {
  Names names{"region"};
  std::vector<Region> regions;  // as many as the body has; empty of nodes where something was wrong
};

// The regions of a body. `mesh` may be nullptr: then only what does not depend on it is checked.
TranslatedRegions TranslateRegions(const v1::Body& body, const std::string& body_path, const TranslatedMesh* mesh,
                                   Problems& problems);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_TRANSLATE_REGIONS_H_
