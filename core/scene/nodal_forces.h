#ifndef FASCICLE_CORE_SCENE_NODAL_FORCES_H_
#define FASCICLE_CORE_SCENE_NODAL_FORCES_H_

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "core/base/types.h"
#include "core/geometry/region.h"
#include "core/scene/acting.h"

namespace fascicle {

// The region on which a load acts, for any element type.
struct LoadedRegion {
  // A face of the rest surface, and the nodes that share a force on it in equal parts. This is consistent with the
  // shape functions of linear triangles and bilinear quads, whose nodes are the corners, and of quadratic triangles,
  // whose nodes are the mid-edge nodes.
  struct Face {
    Vec3 area = Vec3::Zero();  // outward normal times area [m^2]
    int count = 0;             // number of nodes
    std::array<std::int32_t, 4> nodes = {};
  };
  std::vector<std::int32_t> nodes;
  std::vector<Face> faces;
};

// A region of a mesh that has corner nodes only.
//   X  rest positions of the mesh's nodes [m]
LoadedRegion LoadedRegionOf(const Region& region, const std::vector<Vec3>& X);

// Whether this load acts on faces, so that the region must have some.
bool NeedsSurface(const Load& load);

// The force of a load on each node at scale 1 [N]; ordered by node, so that sums are reproducible.
// To add a kind of load: a message in scene.proto, a struct in acting.h, its translation, and its two functions in
// nodal_forces.cc.
std::map<std::int32_t, Vec3> NodalForcesOf(const Load& load, const LoadedRegion& region);

}  // namespace fascicle

#endif  // FASCICLE_CORE_SCENE_NODAL_FORCES_H_
