#ifndef FASCICLE_CORE_SKELETON_PLACEMENT_H_
#define FASCICLE_CORE_SKELETON_PLACEMENT_H_

#include "core/base/pose.h"

namespace fascicle {

// A frame by the place of its origin and rotations about its own x, y and z axes in turn [rad].
Pose PoseByAngles(const Vec3& position, const Vec3& angles);
// These angles of a pose.
Vec3 AnglesOf(const Pose& pose);

// A frame that is given in another one.
Pose operator*(const Pose& outer, const Pose& inner);

}  // namespace fascicle

#endif  // FASCICLE_CORE_SKELETON_PLACEMENT_H_
