#ifndef FASCICLE_CORE_SIM_BONE_MOTIONS_H_
#define FASCICLE_CORE_SIM_BONE_MOTIONS_H_

#include <memory>
#include <vector>

#include "core/scene/driven_skeleton.h"
#include "core/scene/rigid_motion.h"
#include "core/skeleton/skeleton_mechanics.h"

namespace fascicle {

// The motions of a skeleton's bones from their poses at time 0, for what is fixed to them. A function of time alone.
// Not thread-safe.
class BoneMotions {
 public:
  // The skeleton must outlive it.
  explicit BoneMotions(const DrivenSkeleton& driven);

  // Sets the time of At [s].
  void MoveTo(double time);
  RigidMotion At(int bone) const { return now_[static_cast<std::size_t>(bone)]; }

 private:
  const DrivenSkeleton* driven_;
  std::unique_ptr<SkeletonMechanics> mechanics_;
  std::vector<Pose> start_;
  std::vector<RigidMotion> now_;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_SIM_BONE_MOTIONS_H_
