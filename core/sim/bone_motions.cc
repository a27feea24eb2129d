#include "core/sim/bone_motions.h"

#include <cstddef>

namespace fascicle {

BoneMotions::BoneMotions(const DrivenSkeleton& driven)
    : driven_(&driven),
      mechanics_(std::make_unique<SkeletonMechanics>(driven.skeleton)),
      start_(mechanics_->Poses(driven.motion.At(0))) {
  MoveTo(0);
}

void BoneMotions::MoveTo(double time) {
  const std::vector<BoneMotion> motions = mechanics_->Motions(driven_->motion.At(time), driven_->motion.At(time, 1));
  now_.resize(motions.size());
  for (std::size_t b = 0; b < motions.size(); ++b) {
    const BoneMotion& motion = motions[b];
    RigidMotion& now = now_[b];
    now.rotation = RotationOf(motion.pose) * RotationOf(start_[b]).transpose();
    now.angular_velocity = motion.angular_velocity;
    now.point = start_[b].position;
    now.translation = motion.pose.position - start_[b].position;
    now.velocity = motion.velocity;
  }
}

}  // namespace fascicle
