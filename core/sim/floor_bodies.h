#ifndef FASCICLE_CORE_SIM_FLOOR_BODIES_H_
#define FASCICLE_CORE_SIM_FLOOR_BODIES_H_

#include <vector>

#include "core/scene/scene.h"
#include "core/sim/frame.h"

namespace fascicle {

// The scene's floors as rigid bodies that stay: of each half-space a square of its surface, normal to the z axis of the
// rigid body. Its middle is below that of the box around all bodies at rest, its side twice the diagonal of that box,
// so that whatever lies on it is small beside it.
std::vector<RigidBodyInfo> FloorBodies(const Scene& scene);

}  // namespace fascicle

#endif  // FASCICLE_CORE_SIM_FLOOR_BODIES_H_
