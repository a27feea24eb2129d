#include "server/translate/skeleton.h"

#include <exception>
#include <utility>

#include "core/skeleton/placement.h"
#include "core/skeleton/skeleton_mechanics.h"
#include "server/translate/skeleton_parts.h"
#include "server/translate/values.h"

namespace fascicle::server {
namespace {

const std::string kSkeleton = "skeleton";

template <class Messages>
void AddNames(const Messages& messages, const char* list, Names& names, Problems& problems) {
  for (int i = 0; i < messages.size(); ++i) {
    const std::string path = JoinPath(kSkeleton, IndexPath(list, static_cast<std::size_t>(i)));
    names.Add(messages[i].name(), JoinPath(path, "name"), problems);
  }
}

void CheckCounts(const v1::Skeleton& wire, Problems& problems) {
  CheckCount(wire.bones_size(), 200, "skeleton.bones", problems);
  CheckCount(wire.joints_size(), 200, "skeleton.joints", problems);
  CheckCount(wire.coordinates_size(), 1200, "skeleton.coordinates", problems);
  CheckCount(wire.wrap_surfaces_size(), 500, "skeleton.wrap_surfaces", problems);
  CheckCount(wire.muscles_size(), 500, "skeleton.muscles", problems);
  for (int b = 0; b < wire.bones_size(); ++b) {
    CheckCount(wire.bones(b).shapes_size(), 100,
               JoinPath(kSkeleton, JoinPath(IndexPath("bones", static_cast<std::size_t>(b)), "shapes")), problems);
  }
}

// Simbody's own checks of the skeleton.
std::unique_ptr<SkeletonMechanics> MechanicsOf(const Skeleton& skeleton, Problems& problems) {
  try {
    return std::make_unique<SkeletonMechanics>(skeleton);
  } catch (const std::exception& error) {
    problems.Add(kSkeleton, std::string("is refused by Simbody: ") + error.what());
    return nullptr;
  }
}

void Complete(const v1::Scene& scene, const SkeletonNames& names, const AssetReader& assets,
              const TranslateTools& tools, DrivenSkeleton& driven, Problems& problems) {
  const v1::Skeleton& wire = scene.skeleton();
  TranslateBones(wire, driven.skeleton, problems);
  TranslateJoints(wire, names, driven.skeleton, problems);
  driven.shapes = TranslateBoneShapes(wire, assets, tools, driven.notes, problems);
  TranslateLineMuscles(wire, names, driven.skeleton, problems);
  driven.strength =
      wire.strength() == v1::MUSCLE_STRENGTH_FORCE_LENGTH ? MuscleStrength::kForceLength : MuscleStrength::kConstant;
  driven.motion = TranslateSkeletonMotion(wire, driven.skeleton, names, assets, driven.notes, problems);
  if (!problems.empty()) return;
  const auto mechanics = MechanicsOf(driven.skeleton, problems);
  if (!mechanics) return;
  const StageTimer timer(tools.profile, "activations");
  driven.activations = TranslateMuscleDrive(scene, *mechanics, driven.motion, driven.strength, names, assets, tools,
                                            driven.notes, problems);
}

}  // namespace

Curve TranslatedSkeleton::ActivationOf(const std::string& muscle, const std::string& path, Problems& problems) const {
  const auto index = muscles.Find(muscle, path, problems);
  return index && driven ? driven->activations[*index] : Curve::Constant(0);
}

TranslatedSkeleton TranslateSkeleton(const v1::Scene& scene, const Gravity& gravity, const AssetReader& assets,
                                     const TranslateTools& tools, Problems& problems) {
  TranslatedSkeleton result;
  if (!scene.has_skeleton()) return result;
  const v1::Skeleton& wire = scene.skeleton();
  Problems own;
  SkeletonNames names;
  AddNames(wire.bones(), "bones", names.bones, own);
  AddNames(wire.coordinates(), "coordinates", names.coordinates, own);
  AddNames(wire.wrap_surfaces(), "wrap_surfaces", names.surfaces, own);
  AddNames(wire.muscles(), "muscles", names.muscles, own);
  Names joints("joint");
  AddNames(wire.joints(), "joints", joints, own);
  CheckCounts(wire, own);
  if (wire.bones().empty()) own.Add("skeleton.bones", "is empty", "a skeleton has at least one bone");
  DrivenSkeleton driven;
  driven.skeleton.gravity = gravity.acceleration * gravity.scale.At(0);
  const bool obeys = ObeysRules(wire);  // the rules' problems are reported for the whole scene
  if (obeys && own.empty()) Complete(scene, names, assets, tools, driven, own);
  if (obeys && own.empty()) result.driven = std::move(driven);
  result.bones = std::move(names.bones);
  result.muscles = std::move(names.muscles);
  problems.Append("", own);
  return result;
}

Pose ToPose(const v1::Placement& placement) {
  return PoseByAngles(ToVec3(placement.position()), ToVec3(placement.angles()));
}

void CheckCount(int size, int most, const std::string& path, Problems& problems) {
  if (size > most) problems.Add(path, "has " + std::to_string(size) + " entries", "at most " + std::to_string(most));
}

}  // namespace fascicle::server
