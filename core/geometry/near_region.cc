#include "core/geometry/near_region.h"

#include <algorithm>
#include <utility>

#include "core/base/stop.h"

namespace fascicle {

Region SelectNear(const TetMesh& mesh, const std::vector<Triangle>& surface, std::string name,
                  const TriangleTree& other, double distance, const std::stop_token& stop) {
  Region region;
  region.name = std::move(name);
  enum : char { kUnknown, kNear, kFar };
  std::vector<char> found(mesh.nodes.size(), kUnknown);
  const auto is_near = [&](std::int32_t n) {
    if (found[n] == kUnknown) found[n] = other.Distance(mesh.nodes[n]) <= distance ? kNear : kFar;
    return found[n] == kNear;
  };
  for (const Triangle& triangle : surface) {
    ThrowIfStopped(stop);
    if (!std::all_of(triangle.begin(), triangle.end(), is_near)) continue;
    region.triangles.push_back(triangle);
    region.nodes.insert(region.nodes.end(), triangle.begin(), triangle.end());
  }
  std::sort(region.nodes.begin(), region.nodes.end());
  region.nodes.erase(std::unique(region.nodes.begin(), region.nodes.end()), region.nodes.end());
  return region;
}

}  // namespace fascicle
