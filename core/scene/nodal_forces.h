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

// What a load acts on, whatever the elements.
struct LoadedRegion {
  // A face of the rest surface, and the nodes that what acts on it goes to in equal parts: consistent with the shape
  // functions of linear triangles and bilinear quads, whose corners these are, and of quadratic triangles, where they
  // are the middles of the edges.
  struct Face {
    Vec3 area = Vec3::Zero();  // its outward normal, as long as it is large [m^2]
    int count = 0;             // of nodes
    std::array<std::int32_t, 4> nodes = {};
  };
  std::vector<std::int32_t> nodes;
  std::vector<Face> faces;
};

// A region of a mesh with corner nodes alone.
//   X  rest positions of the mesh's nodes [m]
LoadedRegion LoadedRegionOf(const Region& region, const std::vector<Vec3>& X);

// Whether a load of this kind acts on faces, and the region must have some.
bool NeedsSurface(const Load& load);

// The force of a load on each node at scale 1 [N]; ordered, so that sums do not depend on where things lie in memory.
// To add a kind of load: a message in scene.proto, a struct in acting.h, its translation and its two functions in
// nodal_forces.cc.
std::map<std::int32_t, Vec3> NodalForcesOf(const Load& load, const LoadedRegion& region);

}  // namespace fascicle

#endif  // FASCICLE_CORE_SCENE_NODAL_FORCES_H_
