#include "proto/frames/frame_fits.h"

#include <algorithm>

namespace fascicle {

bool FrameFits(const v1::Frame& frame, const v1::Geometry& geometry) {
  constexpr std::size_t kPose = 7 * sizeof(double);
  const auto& rigid = geometry.rigid_bodies();
  const auto moving = std::count_if(rigid.begin(), rigid.end(), [](const auto& body) { return body.moves(); });
  return frame.bodies_size() == geometry.bodies_size() && frame.lines_size() == geometry.lines_size() &&
         frame.poses().size() == static_cast<std::size_t>(moving) * kPose &&
         frame.series_size() == geometry.series_size();
}

}  // namespace fascicle
