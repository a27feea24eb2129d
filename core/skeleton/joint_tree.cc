#include "core/skeleton/joint_tree.h"

#include <algorithm>

namespace fascicle {

JointTree::JointTree(const Skeleton& skeleton)
    : moved_(skeleton.coordinates.size(), std::vector<bool>(skeleton.bones.size())) {
  for (const Joint& joint : skeleton.joints) {
    for (const auto* three : {&joint.rotations, &joint.translations}) {
      for (const MotionAxis& axis : *three) {
        if (axis.coordinate < 0) continue;
        moved_[static_cast<std::size_t>(axis.coordinate)][static_cast<std::size_t>(joint.child)] = true;
      }
    }
    if (joint.parent < 0) continue;
    // Parents come before their children.
    for (std::vector<bool>& moved : moved_) {
      if (moved[static_cast<std::size_t>(joint.parent)]) moved[static_cast<std::size_t>(joint.child)] = true;
    }
  }
}

bool JointTree::Parts(int coordinate, const std::vector<int>& bones) const {
  const auto moves = [&](int bone) { return Moves(coordinate, bone); };
  return std::any_of(bones.begin(), bones.end(), moves) && !std::all_of(bones.begin(), bones.end(), moves);
}

std::vector<int> BonesOf(const Skeleton& skeleton, const LineMuscle& muscle) {
  std::vector<int> bones;
  for (const PathPoint& point : muscle.points) bones.push_back(point.bone);
  for (const PathWrap& wrap : muscle.wraps) {
    bones.push_back(skeleton.surfaces[static_cast<std::size_t>(wrap.surface)].bone);
  }
  return bones;
}

}  // namespace fascicle
