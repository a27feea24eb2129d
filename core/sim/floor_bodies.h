#ifndef FASCICLE_CORE_SIM_FLOOR_BODIES_H_
#define FASCICLE_CORE_SIM_FLOOR_BODIES_H_

#include <vector>

#include "core/scene/scene.h"
#include "core/sim/frame.h"

namespace fascicle {

// The scene's floors as rigid bodies that do not move: a square of the surface of each half-space. Its centre is below
// that of the bounding box of all bodies at rest, and its side is twice the diagonal of that box.
std::vector<RigidBodyInfo> FloorBodies(const Scene& scene);

}  // namespace fascicle

#endif  // FASCICLE_CORE_SIM_FLOOR_BODIES_H_
