#ifndef FASCICLE_CORE_EULERIAN_GRID_FRAME_H_
#define FASCICLE_CORE_EULERIAN_GRID_FRAME_H_

#include "core/base/pose.h"

namespace fascicle {

// The frame of a grid in the world: point y of the grid is at x = R y + p [Fan 2013, eq. 4.1]. Positions of a body's
// state are points of its grid, and its vectors (velocities, momenta) have components along the axes of the grid.
class GridFrame {
 public:
  // The frame of a grid that does not move.
  GridFrame() = default;
  // travels: whether the grid moves; otherwise the pose is the identity, and everything keeps its bits.
  GridFrame(const Pose& pose, bool travels) : travels_(travels), R_(RotationOf(pose)), p_(pose.position) {}

  Vec3 PointInWorld(const Vec3& y) const { return travels_ ? R_ * y + p_ : y; }
  Vec3 PointInGrid(const Vec3& x) const { return travels_ ? R_.transpose() * (x - p_) : x; }
  Vec3 VectorInWorld(const Vec3& v) const { return travels_ ? R_ * v : v; }
  Vec3 VectorInGrid(const Vec3& v) const { return travels_ ? R_.transpose() * v : v; }
  // Of a tensor whose both legs are in space, such as stress, and of one whose first leg is, such as F.
  Mat3 TensorInWorld(const Mat3& T) const { return travels_ ? R_ * T * R_.transpose() : T; }
  Mat3 GradientInWorld(const Mat3& F) const { return travels_ ? R_ * F : F; }

 private:
  bool travels_ = false;
  Mat3 R_ = Mat3::Identity();
  Vec3 p_ = Vec3::Zero();
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_GRID_FRAME_H_
