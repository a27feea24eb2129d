#ifndef FASCICLE_CORE_SIM_SKELETON_MEASURE_H_
#define FASCICLE_CORE_SIM_SKELETON_MEASURE_H_

#include <span>
#include <utility>
#include <vector>

#include "core/scene/scene.h"
#include "core/scene/support_moment.h"
#include "core/sim/frame.h"
#include "core/skeleton/muscle_path.h"
#include "core/skeleton/skeleton_mechanics.h"

namespace fascicle {

// What frames show of a scene's skeleton: bones as rigid bodies; muscles as lines with activation, length and force;
// and series. These are, for each coordinate, its value (angle or distance), the torque that its joint needs for the
// motion (torque or force), that of the line muscles, and that of the supports of each body that it moves; the force
// and the moment of such supports on each bone; moment arms of the muscles about the coordinates that they cross. A
// function of time and of reactions. Not thread-safe.
class SkeletonMeasure {
 public:
  // The scene must have a skeleton and outlive it.
  explicit SkeletonMeasure(const Scene& scene);

  // Adds the names of all that Measure adds, and the notes.
  void AddTo(FrameLayout& layout);
  // Adds the skeleton's state at the frame's time.
  //   reactions  of all constraints of all bodies, in order
  void Measure(std::span<const Reaction> reactions, Frame& frame);

 private:
  // The constraints of a body that follow bones.
  struct Attachment {
    std::size_t body;
    std::vector<std::size_t> constraints;  // among those of all bodies
    std::vector<int> bones;                // of all its constraints; -1: the ground
  };

  void FindAttachments();
  void AddLines(FrameLayout& layout) const;
  void AddCoordinateSeries(std::vector<SeriesInfo>& series) const;
  void AddBoneSeries(std::vector<SeriesInfo>& series) const;
  void AddMomentArmSeries(std::vector<SeriesInfo>& series) const;
  // What supports do to a bone: the opposite of their reactions.
  std::vector<PointForce> ForcesOn(const Attachment& attachment, std::span<const Reaction> reactions,
                                   const std::vector<Pose>& poses) const;

  const Scene* scene_;
  const DrivenSkeleton* driven_;
  SkeletonMechanics mechanics_;
  std::vector<std::pair<int, int>> arms_;  // the coordinates that each muscle crosses, with the muscle
  std::vector<Attachment> attachments_;
  std::vector<std::pair<int, std::size_t>> pulled_;  // coordinates, and the attachments that have a torque about them
  std::vector<int> bones_;                           // to which bodies are attached, ascending
  std::vector<int> bone_of_constraint_;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_SIM_SKELETON_MEASURE_H_
