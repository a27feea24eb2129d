#ifndef FASCICLE_CLIENT_CLI_MESH_REGIONS_H_
#define FASCICLE_CLIENT_CLI_MESH_REGIONS_H_

#include <memory>
#include <stop_token>
#include <string>
#include <variant>
#include <vector>

#include "core/base/problems.h"
#include "core/geometry/near_region.h"
#include "core/geometry/triangle_mesh.h"

namespace fascicle::client {

// A region requested by `--region NAME=...`; lengths in the surface's unit.
struct RegionRequest {
  // NAME=near:FILE:DISTANCE
  struct Near {
    std::string file;
    TriangleMesh surface;
    double distance = 0;
  };
  // NAME=end:X,Y,Z:LENGTH: within LENGTH of the farthest point along a direction.
  struct End {
    Vec3 direction = Vec3::Zero();
    double length = 0;
  };
  std::string name;
  std::variant<SideSelector, Near, End> selector;
};

// Both ReadRegionRequests and MarkRegions throw Stopped after a stop request.

// Reads `--region` options and the surfaces that they refer to; adds every mistake to `problems`.
std::vector<RegionRequest> ReadRegionRequests(const std::vector<std::string>& options, const std::stop_token& stop,
                                              Problems& problems);

// Checks two regions that are the ends of a muscle: they must not share a node.
void CheckEnds(const Region& origin, const Region& insertion, Problems& problems);

// Tags the triangles of each region, the first region by 1 and so on, and all tetrahedra by the next number. A region
// without triangles is a problem.
std::vector<Region> MarkRegions(const std::vector<RegionRequest>& requests, const std::stop_token& stop, TetMesh& mesh,
                                Problems& problems);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_CLI_MESH_REGIONS_H_
