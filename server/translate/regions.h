#ifndef FASCICLE_SERVER_TRANSLATE_REGIONS_H_
#define FASCICLE_SERVER_TRANSLATE_REGIONS_H_

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/base/problems.h"
#include "core/geometry/region.h"
#include "core/geometry/triangle_mesh.h"
#include "fascicle/v1/scene.pb.h"
#include "server/translate/names.h"

namespace fascicle::server {

// How the regions of a body are selected, whatever mesh they are selected from.
struct RegionSelectors {
  struct Entry {
    std::string name;
    std::optional<Selector> selector;  // in metres; nothing when it is missing or wrong
    std::vector<std::size_t> within;   // the regions before it that it is restricted to
    bool complete = false;             // nothing of it is missing or wrong
  };
  Names names{"region"};
  std::vector<Entry> entries;  // as many as the body has
};
RegionSelectors TranslateRegions(const v1::Body& body, const std::string& body_path, Problems& problems);

// The regions of a mesh (TetMesh, BrickMesh or TriangleMesh), as many as there are selectors; empty of nodes where one
// was wrong.
template <class Mesh>
std::vector<Region> SelectRegions(const RegionSelectors& selectors, const Mesh& mesh);
// Those of a body without a mesh: they have names alone.
std::vector<Region> EmptyRegions(const RegionSelectors& selectors);

// Adds a problem for each region that SelectRegions found nothing for.
template <class Mesh>
void CheckRegions(const v1::Body& body, const std::string& body_path, const RegionSelectors& selectors,
                  const std::vector<Region>& regions, const Mesh& mesh, Problems& problems);

// Regions to be referred to by name.
struct NamedRegions {
  const Names& names;
  const std::vector<Region>& regions;  // as many
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_TRANSLATE_REGIONS_H_
