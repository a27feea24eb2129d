#include <map>
#include <utility>

#include "core/scene/checks.h"

namespace fascicle::scene_checks {
namespace {

bool SameCurve(const Curve& a, const Curve& b) {
  return a.times == b.times && a.values == b.values && a.interpolation == b.interpolation;
}

bool SameCurve(const std::optional<Curve>& a, const std::optional<Curve>& b) {
  return a.has_value() == b.has_value() && (!a || SameCurve(*a, *b));
}

bool SameRotation(const std::optional<Rotation>& a, const std::optional<Rotation>& b) {
  return a.has_value() == b.has_value() &&
         (!a || (a->point == b->point && a->axis == b->axis && SameCurve(a->angle, b->angle)));
}

// Whether both prescribe the same motion along one axis.
bool Agree(const Constraint& a, const Constraint& b, int axis) {
  return a.motion.bone == b.motion.bone && SameCurve(a.motion.translation[axis], b.motion.translation[axis]) &&
         SameRotation(a.motion.rotation, b.motion.rotation);
}

void CheckConstraintsOf(const Body& body, std::int32_t bones, const std::string& path, Problems& problems) {
  // Regions of a surface are volumes, which may contain none of its nodes.
  const bool volumes = std::holds_alternative<SurfaceShape>(body.shape);
  std::map<std::pair<std::int32_t, int>, std::size_t> holder;  // the first constraint on a node and axis
  for (std::size_t k = 0; k < body.constraints.size(); ++k) {
    const Constraint& constraint = body.constraints[k];
    const std::string where = JoinPath(path, IndexPath("constraints", k));
    if (constraint.region < 0 || constraint.region >= static_cast<std::int32_t>(body.regions.size())) {
      problems.Add(JoinPath(where, "region"), "there is no such region");
      continue;
    }
    const Region& region = body.regions[constraint.region];
    if (region.nodes.empty() && !volumes) {
      problems.Add(JoinPath(where, "region"), "region `" + region.name + "` has no nodes");
    }
    if (constraint.motion.bone >= bones) {
      problems.Add(JoinPath(where, "motion.bone"), "there is no such bone");
    }
    bool reported = false;
    for (const std::int32_t node : region.nodes) {
      for (int axis = 0; axis < 3; ++axis) {
        if (!constraint.axes[axis]) continue;
        const auto [first, is_new] = holder.try_emplace({node, axis}, k);
        if (is_new || reported || Agree(body.constraints[first->second], constraint, axis)) continue;
        problems.Add(where,
                     "prescribes a motion of node " + std::to_string(node) + " to move differently along " +
                         "xyz"[axis] + " than " + IndexPath("constraints", first->second) + " does",
                     "regions that share nodes need the same motion, or different axes");
        reported = true;
      }
    }
  }
}

}  // namespace

void CheckConstraints(const Scene& scene, Problems& problems) {
  const auto bones = static_cast<std::int32_t>(scene.skeleton ? scene.skeleton->skeleton.bones.size() : 0);
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    CheckConstraintsOf(scene.bodies[i], bones, IndexPath("bodies", i), problems);
  }
}

}  // namespace fascicle::scene_checks
