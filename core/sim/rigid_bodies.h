#ifndef FASCICLE_CORE_SIM_RIGID_BODIES_H_
#define FASCICLE_CORE_SIM_RIGID_BODIES_H_

#include <vector>

#include "core/scene/controls.h"
#include "core/sim/frame.h"

namespace fascicle {

// What frames show of the scene's rigid bodies: first its floors, which do not move, then its rigid bodies. Of a
// half-space, a square of its surface: its centre is below that of the bounding box of all bodies at rest, and its side
// is twice the diagonal of that box.
std::vector<RigidBodyInfo> RigidBodiesOf(const Scene& scene);

// The poses of those that move, with the controls at a time.
std::vector<Pose> PosesOf(const Scene& scene, const Controls& now);

}  // namespace fascicle

#endif  // FASCICLE_CORE_SIM_RIGID_BODIES_H_
