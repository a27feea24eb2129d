#ifndef FASCICLE_CLIENT_CLI_MESH_REGIONS_H_
#define FASCICLE_CLIENT_CLI_MESH_REGIONS_H_

#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "core/base/problems.h"
#include "core/geometry/near_region.h"
#include "core/geometry/triangle_mesh.h"

namespace fascicle::client {

// What `--region NAME=...` asks for, lengths in the surface's unit.
struct RegionRequest {
  // NAME=near:FILE:DISTANCE
  struct Near {
    std::string file;
    TriangleMesh surface;
    double distance = 0;
  };
  std::string name;
  std::variant<SideSelector, Near> selector;
};

// Reads `--region` options and the surfaces that they name; adds every mistake to `problems`.
std::vector<RegionRequest> ReadRegionRequests(const std::vector<std::string>& options, Problems& problems);

// Marks the triangles of each region, the first by tag 1 and so on, and all tetrahedra by the tag after the last. A
// region without a triangle is a problem.
std::vector<Region> MarkRegions(const std::vector<RegionRequest>& requests, TetMesh& mesh, Problems& problems);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_CLI_MESH_REGIONS_H_
