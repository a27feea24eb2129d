#include "core/sim/skeleton_measure.h"

#include <algorithm>
#include <string>

#include "core/sim/series.h"
#include "core/skeleton/joint_tree.h"
#include "core/skeleton/motion_activations.h"

namespace fascicle {
namespace {

const char* ValueName(const Coordinate& coordinate) { return coordinate.is_angle ? "angle" : "distance"; }
// Of a generalized force.
const char* TorqueName(const Coordinate& coordinate) { return coordinate.is_angle ? "torque" : "force"; }
const char* TorqueUnit(const Coordinate& coordinate) { return coordinate.is_angle ? "N m" : "N"; }

std::string PathOf(const std::string& name) { return "skeleton/" + name + "/"; }

bool Contains(const std::vector<int>& list, int value) {
  return std::find(list.begin(), list.end(), value) != list.end();
}

}  // namespace

SkeletonMeasure::SkeletonMeasure(const Scene& scene)
    : scene_(&scene), driven_(&*scene.skeleton), mechanics_(driven_->skeleton) {
  FindAttachments();
  const Skeleton& skeleton = driven_->skeleton;
  const JointTree tree(skeleton);
  for (int m = 0; m < static_cast<int>(skeleton.muscles.size()); ++m) {
    const std::vector<int> bones = BonesOf(skeleton, skeleton.muscles[static_cast<std::size_t>(m)]);
    for (int c = 0; c < static_cast<int>(skeleton.coordinates.size()); ++c) {
      if (tree.Parts(c, bones)) arms_.emplace_back(c, m);
    }
  }
  for (int c = 0; c < static_cast<int>(skeleton.coordinates.size()); ++c) {
    for (std::size_t a = 0; a < attachments_.size(); ++a) {
      if (tree.Parts(c, attachments_[a].bones)) pulled_.emplace_back(c, a);
    }
  }
}

void SkeletonMeasure::FindAttachments() {
  for (std::size_t b = 0; b < scene_->bodies.size(); ++b) {
    Attachment attachment{b, {}, {}};
    for (const Constraint& constraint : scene_->bodies[b].constraints) {
      const int bone = constraint.motion.bone;
      attachment.bones.push_back(bone);
      if (bone >= 0) attachment.constraints.push_back(bone_of_constraint_.size());
      if (bone >= 0 && !Contains(bones_, bone)) bones_.push_back(bone);
      bone_of_constraint_.push_back(bone);
    }
    if (!attachment.constraints.empty()) attachments_.push_back(std::move(attachment));
  }
  std::sort(bones_.begin(), bones_.end());
}

void SkeletonMeasure::AddTo(FrameLayout& layout) {
  const std::vector<Pose> poses = mechanics_.Poses(driven_->motion.At(0));
  for (std::size_t b = 0; b < poses.size(); ++b) {
    layout.rigid_bodies.push_back({driven_->skeleton.bones[b].name, driven_->shapes[b], poses[b], true, false});
  }
  AddLines(layout);
  AddCoordinateSeries(layout.series);
  AddBoneSeries(layout.series);
  AddMomentArmSeries(layout.series);
  layout.notes.insert(layout.notes.end(), driven_->notes.begin(), driven_->notes.end());
}

void SkeletonMeasure::AddLines(FrameLayout& layout) const {
  for (const LineMuscle& muscle : driven_->skeleton.muscles) {
    layout.lines.push_back({muscle.name,
                            {{"activation", "1", "activation of the muscle"},
                             {"length", "m", "length of the muscle's path"},
                             {"force", "N", "force along the muscle, from its activation"}}});
  }
}

void SkeletonMeasure::AddCoordinateSeries(std::vector<SeriesInfo>& series) const {
  for (std::size_t c = 0; c < driven_->skeleton.coordinates.size(); ++c) {
    const Coordinate& coordinate = driven_->skeleton.coordinates[c];
    const std::string path = PathOf(coordinate.name), torque = TorqueName(coordinate), unit = TorqueUnit(coordinate);
    series.push_back({path + ValueName(coordinate), coordinate.is_angle ? "rad" : "m", "value of the coordinate"});
    series.push_back(
        {path + torque, unit, torque + " that the joint needs for the motion, against gravity and inertia"});
    series.push_back({path + "muscle_" + torque, unit, torque + " of all line muscles about the coordinate"});
    for (const auto& [moved, a] : pulled_) {
      if (moved != static_cast<int>(c)) continue;
      const std::string& body = scene_->bodies[attachments_[a].body].name;
      series.push_back({path + torque + "/" + body, unit, torque + " of `" + body + "` about the coordinate"});
    }
  }
}

void SkeletonMeasure::AddBoneSeries(std::vector<SeriesInfo>& series) const {
  for (const int bone : bones_) {
    const std::string& name = driven_->skeleton.bones[static_cast<std::size_t>(bone)].name;
    for (const char* axis : kAxisNames) {
      series.push_back(
          {PathOf(name) + "pull/" + axis, "N", std::string("force of all attached bodies on the bone along ") + axis});
    }
    for (const char* axis : kAxisNames) {
      series.push_back({PathOf(name) + "moment/" + axis, "N m",
                        std::string("moment of all attached bodies on the bone about its origin, along ") + axis});
    }
  }
}

void SkeletonMeasure::AddMomentArmSeries(std::vector<SeriesInfo>& series) const {
  for (const auto& [c, m] : arms_) {
    const Coordinate& coordinate = driven_->skeleton.coordinates[static_cast<std::size_t>(c)];
    const std::string& muscle = driven_->skeleton.muscles[static_cast<std::size_t>(m)].name;
    series.push_back({PathOf(muscle) + "moment_arm/" + coordinate.name, coordinate.is_angle ? "m" : "1",
                      "moment arm of `" + muscle + "`: positive where its tension increases the coordinate"});
  }
}

std::vector<PointForce> SkeletonMeasure::ForcesOn(const Attachment& attachment, std::span<const Reaction> reactions,
                                                  const std::vector<Pose>& poses) const {
  std::vector<PointForce> forces;
  for (const std::size_t k : attachment.constraints) {
    const int bone = bone_of_constraint_[k];
    const Pose& pose = poses[static_cast<std::size_t>(bone)];
    // Moments of reactions are about the world's origin.
    const Vec3 moment = reactions[k].moment - pose.position.cross(reactions[k].force);
    forces.push_back({bone, Vec3::Zero(), -reactions[k].force, -moment});
  }
  return forces;
}

void SkeletonMeasure::Measure(std::span<const Reaction> reactions, Frame& frame) {
  const Skeleton& skeleton = driven_->skeleton;
  const Eigen::VectorXd q = driven_->motion.At(frame.time);
  const std::vector<Pose> poses = mechanics_.Poses(q);
  frame.poses.insert(frame.poses.end(), poses.begin(), poses.end());
  const auto muscles = static_cast<Eigen::Index>(skeleton.muscles.size());
  Eigen::MatrixXd arms(q.size(), muscles);
  Eigen::VectorXd forces(muscles);
  for (Eigen::Index m = 0; m < muscles; ++m) {
    const LineMuscle& muscle = skeleton.muscles[static_cast<std::size_t>(m)];
    const MusclePath path = fascicle::PathOf(skeleton, muscle, q, poses);
    arms.col(m) = mechanics_.GeneralizedForces(q, path.UnitForces());
    const double activation = driven_->activations[static_cast<std::size_t>(m)].At(frame.time);
    forces[m] = ForceOf(muscle, driven_->strength, path.length).At(activation);
    LineFrame& line = frame.lines.emplace_back();
    for (const MusclePath::Point& point : path.points) line.points.push_back(point.world);
    line.values = {activation, path.length, forces[m]};
  }
  const Eigen::VectorXd torques = TorquesOf(mechanics_, driven_->motion, frame.time, false);
  const Eigen::VectorXd of_muscles = arms * forces;
  std::vector<std::vector<PointForce>> on_bones;
  std::vector<Eigen::VectorXd> of_bodies;
  for (const Attachment& attachment : attachments_) {
    on_bones.push_back(ForcesOn(attachment, reactions, poses));
    of_bodies.push_back(mechanics_.GeneralizedForces(q, on_bones.back()));
  }
  for (Eigen::Index c = 0; c < q.size(); ++c) {
    frame.series.insert(frame.series.end(), {q[c], torques[c], of_muscles[c]});
    for (const auto& [moved, a] : pulled_) {
      if (moved == c) frame.series.push_back(of_bodies[a][c]);
    }
  }
  for (const int bone : bones_) {
    Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
    for (const std::vector<PointForce>& of_body : on_bones) {
      for (const PointForce& one : of_body) {
        if (one.bone != bone) continue;
        force += one.force;
        moment += one.moment;
      }
    }
    frame.series.insert(frame.series.end(), force.begin(), force.end());
    frame.series.insert(frame.series.end(), moment.begin(), moment.end());
  }
  for (const auto& [c, m] : arms_) frame.series.push_back(arms(c, m));
}

}  // namespace fascicle
