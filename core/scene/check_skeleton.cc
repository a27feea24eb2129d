#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "core/scene/checks.h"

namespace fascicle::scene_checks {
namespace {

// Names of the rigid bodies in frames.
void CheckBoneNames(const Scene& scene, Problems& problems) {
  std::set<std::string> names;
  for (const Floor& floor : scene.floors) names.insert(floor.name);
  for (const RigidBody& rigid : scene.rigid_bodies) names.insert(rigid.name);
  const std::vector<Bone>& bones = scene.skeleton->skeleton.bones;
  for (std::size_t b = 0; b < bones.size(); ++b) {
    if (names.insert(bones[b].name).second) continue;
    problems.Add(JoinPath("skeleton", JoinPath(IndexPath("bones", b), "name")),
                 "another bone, a rigid body or a floor is called `" + bones[b].name + "`", "give each a unique name");
  }
}

// Bodies and line muscles have a series called NAME/activation each.
void CheckMuscleNames(const Scene& scene, Problems& problems) {
  std::set<std::string> bodies;
  for (const Body& body : scene.bodies) bodies.insert(body.name);
  const std::vector<LineMuscle>& muscles = scene.skeleton->skeleton.muscles;
  for (std::size_t m = 0; m < muscles.size(); ++m) {
    if (!bodies.contains(muscles[m].name)) continue;
    problems.Add(JoinPath("skeleton", JoinPath(IndexPath("muscles", m), "name")),
                 "a body is called `" + muscles[m].name + "`, and their series would have the same names",
                 "call the muscle `" + muscles[m].name + "_line`, say");
  }
}

void CheckMotion(const DrivenSkeleton& driven, Problems& problems) {
  if (driven.motion.coordinates.size() != driven.skeleton.coordinates.size()) {
    problems.Add("skeleton.motion", "there is not one motion for each coordinate");
    return;
  }
  for (std::size_t c = 0; c < driven.motion.coordinates.size(); ++c) {
    const CoordinateMotion& motion = driven.motion.coordinates[c];
    if (motion.last >= motion.first && std::isfinite(motion.At(motion.first)) && std::isfinite(motion.At(motion.last)))
      continue;
    problems.Add("skeleton.motion",
                 "the motion of `" + driven.skeleton.coordinates[c].name + "` is not finite, or its times descend");
  }
}

}  // namespace

void CheckSkeleton(const Scene& scene, Problems& problems) {
  if (!scene.skeleton) return;
  const std::vector<double>& scales = scene.gravity.scale.values;
  if (std::adjacent_find(scales.begin(), scales.end(), std::not_equal_to<>()) != scales.end()) {
    problems.Add("gravity.scale", "changes, but that of a skeleton is constant", "omit the scale");
  }
  const DrivenSkeleton& driven = *scene.skeleton;
  CheckBoneNames(scene, problems);
  CheckMuscleNames(scene, problems);
  CheckMotion(driven, problems);
  if (driven.shapes.size() != driven.skeleton.bones.size()) {
    problems.Add("skeleton.bones", "there is not one shape for each bone");
  }
  if (driven.activations.size() != driven.skeleton.muscles.size()) {
    problems.Add("skeleton.drive", "there is not one activation for each muscle");
  }
  for (const Curve& curve : driven.activations) {
    for (const double value : curve.values) {
      if (value >= 0 && value <= 1) continue;
      problems.Add("skeleton.drive", "an activation is not within [0, 1]");
      return;
    }
  }
}

}  // namespace fascicle::scene_checks
