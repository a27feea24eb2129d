#include "client/import/encode_skeleton.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/skeleton/placement.h"

namespace fascicle::client {
namespace {

using Numbers = google::protobuf::RepeatedField<double>;

constexpr std::size_t kMostLetters = 64;

void Put(const Vec3& v, Numbers& numbers) { numbers.Assign(v.begin(), v.end()); }

void PutUnlessZero(const Vec3& v, Numbers& numbers) {
  if (!v.isZero(0)) Put(v, numbers);
}

v1::Placement Encode(const Pose& pose) {
  v1::Placement placement;
  PutUnlessZero(pose.position, *placement.mutable_position());
  PutUnlessZero(AnglesOf(pose), *placement.mutable_angles());
  return placement;
}

bool IsPlaced(const v1::Placement& placement) { return placement.position_size() + placement.angles_size() > 0; }

v1::CoordinateFunction Encode(const ScalarFunction& function) {
  v1::CoordinateFunction encoded;
  if (function.breaks.empty()) {
    const std::vector<double>& c = function.pieces[0];
    encoded.mutable_coefficients()->Assign(c.begin(), c.end());
    if (c.empty()) encoded.add_coefficients(0);
    return encoded;
  }
  encoded.mutable_x()->Assign(function.breaks.begin(), function.breaks.end());
  for (const double x : function.breaks) encoded.add_y(function.At(x));
  if (function.pieces[0].size() == 2) encoded.set_curve(v1::FUNCTION_CURVE_LINEAR);
  return encoded;
}

bool IsIdentity(const ScalarFunction& f) { return f.breaks.empty() && f.pieces[0] == std::vector<double>{0, 1}; }

// Makes names of a scene, unique in their list.
class Renamer {
 public:
  explicit Renamer(std::vector<std::string>& renamed) : renamed_(renamed) {}

  template <class Named>
  void Rename(std::vector<Named>& list) {
    std::set<std::string> used;
    for (Named& one : list) {
      std::string name = SceneName(one.name);
      const std::string stem = name.substr(0, kMostLetters - 6);
      for (int k = 2; used.contains(name); ++k) name = stem + "_" + std::to_string(k);
      if (name != one.name) renamed_.push_back("`" + one.name + "` is called `" + name + "`");
      used.insert(name);
      one.name = name;
    }
  }

 private:
  std::vector<std::string>& renamed_;
};

class Encoder {
 public:
  explicit Encoder(const Skeleton& skeleton) : from_(skeleton) {}

  v1::Skeleton Encode() {
    for (const Bone& bone : from_.bones) EncodeBone(bone);
    for (const Joint& joint : from_.joints) EncodeJoint(joint);
    for (std::size_t c = 0; c < from_.coordinates.size(); ++c) {
      if (used_.contains(static_cast<int>(c))) EncodeCoordinate(from_.coordinates[c]);
    }
    for (const WrapSurface& surface : from_.surfaces) EncodeSurface(surface);
    for (const LineMuscle& muscle : from_.muscles) EncodeMuscle(muscle);
    return std::move(to_);
  }

 private:
  std::string BoneName(int bone) const {
    return bone < 0 ? std::string() : from_.bones[static_cast<std::size_t>(bone)].name;
  }
  std::string CoordinateName(int coordinate) const {
    return from_.coordinates[static_cast<std::size_t>(coordinate)].name;
  }

  void EncodeBone(const Bone& from) {
    v1::Bone& bone = *to_.add_bones();
    bone.set_name(from.name);
    if (from.mass > 0) {
      bone.set_mass(from.mass);
      PutUnlessZero(from.mass_centre, *bone.mutable_mass_centre());
      const Mat3& I = from.inertia;
      for (const double moment : {I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2)}) bone.add_inertia(moment);
    }
    for (const BoneSurface& surface : from.surfaces) {
      v1::BoneShape& shape = *bone.add_shapes();
      shape.mutable_file()->set_path(surface.file);
      if (surface.scale != Vec3::Ones()) Put(surface.scale, *shape.mutable_scale());
      const v1::Placement placement = client::Encode(surface.pose);
      if (IsPlaced(placement)) *shape.mutable_placement() = placement;
    }
  }

  void EncodeJoint(const Joint& from) {
    v1::Joint& joint = *to_.add_joints();
    joint.set_name(from.name);
    joint.set_parent(BoneName(from.parent));
    joint.set_child(BoneName(from.child));
    const v1::Placement in_parent = client::Encode(from.in_parent), in_child = client::Encode(from.in_child);
    if (IsPlaced(in_parent)) *joint.mutable_in_parent() = in_parent;
    if (IsPlaced(in_child)) *joint.mutable_in_child() = in_child;
    for (const MotionAxis& axis : from.rotations) EncodeAxis(axis, *joint.mutable_rotations());
    for (const MotionAxis& axis : from.translations) EncodeAxis(axis, *joint.mutable_translations());
  }

  // Axes without effect are left out.
  void EncodeAxis(const MotionAxis& from, google::protobuf::RepeatedPtrField<v1::JointAxis>& axes) {
    if (from.coordinate < 0 && from.function.At(0) == 0) return;
    v1::JointAxis& axis = *axes.Add();
    Put(from.axis, *axis.mutable_axis());
    if (from.coordinate < 0) {
      axis.mutable_function()->add_coefficients(from.function.At(0));
      return;
    }
    used_.insert(from.coordinate);
    axis.set_coordinate(CoordinateName(from.coordinate));
    if (!IsIdentity(from.function)) *axis.mutable_function() = client::Encode(from.function);
  }

  void EncodeCoordinate(const Coordinate& from) {
    v1::Coordinate& coordinate = *to_.add_coordinates();
    coordinate.set_name(from.name);
    if (from.start != 0) coordinate.set_value(from.start);
    if (std::isfinite(from.range[0]) && std::isfinite(from.range[1]) && from.range[0] < from.range[1]) {
      coordinate.mutable_range()->Assign(from.range.begin(), from.range.end());
    }
    if (from.locked) coordinate.set_locked(true);
  }

  void EncodeSurface(const WrapSurface& from) {
    v1::WrapSurface& surface = *to_.add_wrap_surfaces();
    surface.set_name(from.name);
    surface.set_bone(BoneName(from.bone));
    const v1::Placement placement = client::Encode(from.pose);
    if (IsPlaced(placement)) *surface.mutable_placement() = placement;
    switch (from.kind) {
      case WrapSurface::Kind::kCylinder:
        surface.mutable_cylinder()->set_radius(from.radius);
        surface.mutable_cylinder()->set_length(from.length);
        break;
      case WrapSurface::Kind::kSphere:
        surface.mutable_sphere()->set_radius(from.radius);
        break;
      case WrapSurface::Kind::kEllipsoid:
        Put(from.radii, *surface.mutable_ellipsoid()->mutable_radii());
        break;
    }
    if (from.side != 0) {
      surface.set_side(static_cast<v1::WrapSide>(1 + 2 * from.side_axis + (from.side < 0 ? 1 : 0)));
    }
  }

  void EncodeMuscle(const LineMuscle& from) {
    v1::LineMuscle& muscle = *to_.add_muscles();
    muscle.set_name(from.name);
    for (const PathPoint& point : from.points) EncodePoint(point, *muscle.add_points());
    for (const PathWrap& from_wrap : from.wraps) {
      v1::PathWrap& wrap = *muscle.add_wraps();
      wrap.set_surface(from_.surfaces[static_cast<std::size_t>(from_wrap.surface)].name);
      if (from_wrap.first > 0) wrap.set_first_point(from_wrap.first);
      if (from_wrap.last + 1 < static_cast<int>(from.points.size())) wrap.set_last_point(from_wrap.last);
    }
    muscle.set_max_isometric_force(from.max_isometric_force);
    if (from.optimal_fibre_length > 0) muscle.set_optimal_fibre_length(from.optimal_fibre_length);
    if (from.tendon_slack_length > 0) muscle.set_tendon_slack_length(from.tendon_slack_length);
    if (from.pennation != 0) muscle.set_pennation(from.pennation);
    muscle.set_active_width(from.hill.active_width);
    muscle.set_passive_strain(from.hill.passive_strain);
    muscle.set_passive_shape(from.hill.passive_shape);
  }

  void EncodePoint(const PathPoint& from, v1::PathPoint& point) {
    point.set_bone(BoneName(from.bone));
    Put(from.place, *point.mutable_place());
    if (from.condition >= 0) {
      point.set_condition(CoordinateName(from.condition));
      point.mutable_range()->Assign(from.range.begin(), from.range.end());
    }
    for (int axis = 0; axis < 3; ++axis) {
      const int by = from.moved_by[static_cast<std::size_t>(axis)];
      if (by < 0) continue;
      v1::MovedPlace& moved = *point.add_moved();
      moved.set_axis(static_cast<v1::Axis>(v1::AXIS_X + axis));
      moved.set_coordinate(CoordinateName(by));
      *moved.mutable_function() = client::Encode(from.moved[static_cast<std::size_t>(axis)]);
    }
  }

  const Skeleton& from_;
  v1::Skeleton to_;
  std::set<int> used_;  // coordinates that move joints
};

}  // namespace

std::string SceneName(const std::string& name) {
  std::string allowed = name.substr(0, kMostLetters);
  for (char& c : allowed) {
    const bool is_letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (!is_letter && c != '_' && c != '-' && c != '.') c = '_';
  }
  return allowed.empty() || allowed == "." || allowed == ".." ? "unnamed" : allowed;
}

v1::Skeleton EncodeSkeleton(Skeleton skeleton, std::vector<std::string>& renamed) {
  Renamer renamer(renamed);
  renamer.Rename(skeleton.bones);
  renamer.Rename(skeleton.joints);
  renamer.Rename(skeleton.coordinates);
  renamer.Rename(skeleton.surfaces);
  renamer.Rename(skeleton.muscles);
  return Encoder(skeleton).Encode();
}

}  // namespace fascicle::client
