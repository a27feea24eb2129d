#ifndef FASCICLE_CORE_SKELETON_JOINT_TREE_H_
#define FASCICLE_CORE_SKELETON_JOINT_TREE_H_

#include <vector>

#include "core/skeleton/skeleton.h"

namespace fascicle {

// Which bones each coordinate moves: those beyond its joint. Immutable.
class JointTree {
 public:
  explicit JointTree(const Skeleton& skeleton);

  bool Moves(int coordinate, int bone) const {
    return bone >= 0 && moved_[static_cast<std::size_t>(coordinate)][static_cast<std::size_t>(bone)];
  }
  // Whether a coordinate moves some of the bones (-1: the ground) and not the others, so that forces between them have
  // a torque about it.
  bool Parts(int coordinate, const std::vector<int>& bones) const;

 private:
  std::vector<std::vector<bool>> moved_;  // coordinates x bones
};

// The bones of a muscle's points and surfaces.
std::vector<int> BonesOf(const Skeleton& skeleton, const LineMuscle& muscle);

}  // namespace fascicle

#endif  // FASCICLE_CORE_SKELETON_JOINT_TREE_H_
