#ifndef FASCICLE_SERVER_TRANSLATE_REGIONS_H_
#define FASCICLE_SERVER_TRANSLATE_REGIONS_H_

#include <cstddef>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "core/base/problems.h"
#include "core/geometry/region.h"
#include "core/geometry/triangle_mesh.h"
#include "fascicle/v1/scene.pb.h"
#include "server/translate/names.h"

namespace fascicle::server {

// How the regions of a body are selected, independently of the mesh.
struct RegionSelectors {
  struct Entry {
    std::string name;
    std::optional<Selector> selector;  // in metres; nothing if it is missing or invalid
    std::vector<std::size_t> within;   // earlier regions to which it is restricted
    bool complete = false;             // whether nothing is missing or invalid
  };
  Names names{"region"};
  std::vector<Entry> entries;  // one for each region of the body
};
RegionSelectors TranslateRegions(const v1::Body& body, const std::string& body_path, Problems& problems);

// The regions of a mesh (TetMesh, BrickMesh or TriangleMesh), one for each selector; without nodes where a selector is
// invalid, and where the regions before it take too much memory. Throws Stopped after a stop request.
template <class Mesh>
std::vector<Region> SelectRegions(const RegionSelectors& selectors, const Mesh& mesh, const std::stop_token& stop);
// The regions of a body without a mesh: names only.
std::vector<Region> EmptyRegions(const RegionSelectors& selectors);

// Adds a problem for each region for which SelectRegions found nothing, and for the first that it left out.
template <class Mesh>
void CheckRegions(const v1::Body& body, const std::string& body_path, const RegionSelectors& selectors,
                  const std::vector<Region>& regions, const Mesh& mesh, Problems& problems);

// Regions that can be referred to by name.
struct NamedRegions {
  const Names& names;
  const std::vector<Region>& regions;  // one for each name
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_TRANSLATE_REGIONS_H_
