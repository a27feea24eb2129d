#include "core/sim/control_source.h"

#include <algorithm>
#include <set>
#include <string>

#include "core/scene/curves.h"

namespace fascicle {
namespace {

// The curves of muscles with dynamics.
std::set<const Curve*> FollowedCurves(const Scene& scene) {
  std::set<const Curve*> curves;
  for (const Body& body : scene.bodies) {
    if (body.excitation) curves.insert(&body.excitation->curve);
    for (const Load& load : body.loads) {
      if (load.stern) curves.insert({&load.stern->drive.angle, &load.stern->drive.activation});
    }
  }
  return curves;
}

// The time after which all other curves, and the skeleton's motion, are constant [s].
double CurvesEnd(const Scene& scene) {
  const std::set<const Curve*> followed = FollowedCurves(scene);
  double end = scene.skeleton ? scene.skeleton->motion.end() : 0;
  VisitCurves(scene, [&](const Curve& curve, const std::string&) {
    if (curve.times.size() > 1 && !followed.contains(&curve)) end = std::max(end, curve.end());
  });
  return end;
}

bool FollowsBone(const Constraint& constraint) { return constraint.motion.bone >= 0; }

bool HasAttachments(const Scene& scene) {
  return std::any_of(scene.bodies.begin(), scene.bodies.end(), [](const Body& body) {
    return std::any_of(body.constraints.begin(), body.constraints.end(), FollowsBone);
  });
}

}  // namespace

ControlSource::ControlSource(const Scene& scene) : scene_(&scene), curves_end_(CurvesEnd(scene)) {
  for (const Body& body : scene.bodies) {
    std::optional<IntegratedActivation>& activation = activations_.emplace_back();
    if (body.excitation) activation.emplace(body.excitation->curve, body.excitation->dynamics, scene.duration);
    for (const fascicle::Load& load : body.loads) {
      std::optional<SternForce>& pull = pulls_.emplace_back();
      if (load.stern) pull.emplace(load.stern->muscle, load.stern->drive, scene.duration);
    }
  }
  if (HasAttachments(scene)) bones_.emplace(*scene.skeleton);
}

void ControlSource::Evaluate(double time, Controls& controls) {
  controls.time = time;
  controls.gravity_scale = scene_->gravity.scale.At(time);
  controls.force_field_scales.clear();
  for (const PlaneForceField& field : scene_->squeezes) controls.force_field_scales.push_back(field.scale.At(time));
  controls.rigid_motions.clear();
  for (const RigidBody& rigid : scene_->rigid_bodies) controls.rigid_motions.push_back(RigidMotionAt(rigid, time));
  controls.activations.clear();
  controls.load_scales.clear();
  controls.motions.clear();
  if (bones_) bones_->MoveTo(time);
  for (std::size_t b = 0; b < scene_->bodies.size(); ++b) {
    const Body& body = scene_->bodies[b];
    controls.activations.push_back(activations_[b] ? activations_[b]->At(time) : body.activation.At(time));
    if (const auto* shape = std::get_if<TetShape>(&body.shape)) {
      for (const Curve& activation : shape->activations.more) controls.activations.push_back(activation.At(time));
    }
    for (const fascicle::Load& load : body.loads) {
      std::optional<SternForce>& pull = pulls_[controls.load_scales.size()];
      controls.load_scales.push_back(pull ? pull->At(time) : load.scale.At(time));
    }
    for (const Constraint& constraint : body.constraints) {
      controls.motions.push_back(FollowsBone(constraint) ? bones_->At(constraint.motion.bone)
                                                         : MotionAt(constraint.motion, time));
    }
  }
  if (!steering_.empty()) ApplySteering(time, controls);
}

void ControlSource::ApplySteering(double time, Controls& controls) const {
  constexpr SteeringTable::Value kOne = {1, 0};
  const auto scale = [&](ControlKind kind, std::vector<double>& values) {
    for (std::size_t k = 0; k < values.size(); ++k) values[k] *= steering_.At(kind, k, time, kOne).value;
  };
  for (std::size_t k = 0; k < controls.activations.size(); ++k) {
    controls.activations[k] = steering_.At(ControlKind::kActivation, k, time, {controls.activations[k], 0}).value;
  }
  scale(ControlKind::kLoad, controls.load_scales);
  scale(ControlKind::kForceField, controls.force_field_scales);
  controls.gravity_scale *= steering_.At(ControlKind::kGravity, 0, time, kOne).value;
  std::size_t motion = 0;
  for (const Body& body : scene_->bodies) {
    for (const Constraint& constraint : body.constraints) {
      const SteeringTable::Value factor = steering_.At(ControlKind::kMotion, motion, time, kOne);
      if (!FollowsBone(constraint) && (factor.value != 1 || factor.rate != 0)) {
        controls.motions[motion] = ScaledMotionAt(constraint.motion, time, factor.value, factor.rate);
      }
      ++motion;
    }
  }
}

Controls ControlSource::At(double time) {
  Controls controls;
  Evaluate(time, controls);
  return controls;
}

template <class Self, class Call>
void ControlSource::ForLazy(Self& self, const Call& call) {
  for (auto& activation : self.activations_) {
    if (activation) call(*activation);
  }
  for (auto& pull : self.pulls_) {
    if (pull) call(*pull);
  }
}

bool ControlSource::RestsAt(double time) {
  bool rests = time >= curves_end_ && steering_.RestsAt(time);
  ForLazy(*this, [&](auto& curve) { rests = rests && curve.RestsAt(time); });
  return rests;
}

void ControlSource::DiscardBefore(double time) {
  ForLazy(*this, [&](auto& curve) { curve.DiscardBefore(time); });
  steering_.DiscardBefore(time);
}

void ControlSource::Save(ArchiveWriter& archive) const {
  ForLazy(*this, [&](const auto& curve) { curve.Save(archive); });
  steering_.Save(archive);
}

void ControlSource::Load(ArchiveReader& archive) {
  ForLazy(*this, [&](auto& curve) { curve.Load(archive); });
  steering_.Load(archive);
}

}  // namespace fascicle
