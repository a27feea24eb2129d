#ifndef FASCICLE_CORE_SCENE_SUPPORT_MOMENT_H_
#define FASCICLE_CORE_SCENE_SUPPORT_MOMENT_H_

#include "core/scene/scene.h"

namespace fascicle {

// What a support does to its body.
struct Reaction {
  Vec3 force = Vec3::Zero();   // [N]
  Vec3 moment = Vec3::Zero();  // of its forces, at the current positions, about the origin [N m]
};

// The centroid of a region's faces at rest, weighted by area; the mean of its nodes if it has no faces; the mean of all
// nodes if it has neither, as inside of a surface [m].
Vec3 CentroidOf(const Region& region, const std::vector<Vec3>& nodes);

// The point and the axis for the moment of a support of a region: those of Output::moments, or the default point and no
// axis.
struct MomentReference {
  Vec3 point = Vec3::Zero();  // [m]
  std::optional<Vec3> axis;   // unit
};
MomentReference MomentReferenceOf(const Scene& scene, std::size_t body, std::int32_t region);

}  // namespace fascicle

#endif  // FASCICLE_CORE_SCENE_SUPPORT_MOMENT_H_
