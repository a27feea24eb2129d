#include "server/translate/curves.h"
#include "server/translate/supports_and_loads.h"
#include "server/translate/values.h"

namespace fascicle::server {
namespace {

const char kAxes[] = "x, y or z";

// 0, 1, 2; nothing, with a problem, for AXIS_UNSPECIFIED. Unknown numbers are reported by the rules.
std::optional<std::size_t> AxisIndex(v1::Axis axis, const std::string& path, Problems& problems) {
  if (axis >= v1::AXIS_X && axis <= v1::AXIS_Z) return static_cast<std::size_t>(axis - v1::AXIS_X);
  if (axis == v1::AXIS_UNSPECIFIED) problems.Add(path, "is missing", kAxes);
  return std::nullopt;
}

std::string AxisName(std::size_t axis) { return {static_cast<char>('x' + axis)}; }

std::array<bool, 3> TranslateAxes(const v1::Constraint& constraint, const std::string& path, Problems& problems) {
  if (constraint.axes_size() == 0) return {true, true, true};
  std::array<bool, 3> axes = {false, false, false};
  for (int i = 0; i < constraint.axes_size(); ++i) {
    const std::string axis_path = JoinPath(path, IndexPath("axes", static_cast<std::size_t>(i)));
    const auto axis = AxisIndex(constraint.axes(i), axis_path, problems);
    if (!axis) continue;
    if (axes[*axis]) problems.Add(axis_path, AxisName(*axis) + " is listed twice", "list each axis once");
    axes[*axis] = true;
  }
  return axes;
}

void TranslateTranslation(const v1::Motion& motion, const std::array<bool, 3>& axes, const std::string& path,
                          Motion& result, Problems& problems) {
  for (int i = 0; i < motion.translation_size(); ++i) {
    const v1::AxisCurve& translation = motion.translation(i);
    const std::string entry = JoinPath(path, IndexPath("translation", static_cast<std::size_t>(i)));
    const auto axis = AxisIndex(translation.axis(), JoinPath(entry, "axis"), problems);
    Curve curve = Curve::Constant(0);
    if (translation.has_curve()) {
      curve = TranslateCurve(translation.curve(), kTranslationCurve, JoinPath(entry, "curve"), problems);
    } else {
      problems.Add(JoinPath(entry, "curve"), "is missing", "give times [s] and values [m]");
    }
    if (!axis) continue;
    if (result.translation[*axis]) {
      problems.Add(JoinPath(entry, "axis"), AxisName(*axis) + " has a curve already", "one curve for each axis");
    } else if (!axes[*axis]) {
      problems.Add(JoinPath(entry, "axis"), AxisName(*axis) + " has a motion but is not constrained",
                   "add it to the constraint's axes, or omit the axes to constrain all three");
    }
    result.translation[*axis] = std::move(curve);
  }
}

Rotation TranslateRotation(const v1::Rotation& rotation, double metres, const std::string& path, Problems& problems) {
  Rotation result;
  result.point = ToVec3(rotation.point()) * metres;
  result.axis = ToDirection(rotation.axis(), JoinPath(path, "axis"), problems);
  if (rotation.has_angle()) {
    result.angle = TranslateCurve(rotation.angle(), kAngleCurve, JoinPath(path, "angle"), problems);
  } else {
    problems.Add(JoinPath(path, "angle"), "is missing", "give times [s] and values [rad]");
    result.angle = Curve::Constant(0);
  }
  return result;
}

// The bone that a constraint follows; -1 after a problem.
std::int32_t TranslateBone(const v1::Constraint& constraint, const std::string& path,
                           const TranslatedSkeleton& skeleton, Problems& problems) {
  const v1::Motion& motion = constraint.motion();
  const auto bone = skeleton.bones.Find(motion.bone(), path, problems);
  if (motion.translation_size() > 0 || motion.has_rotation()) {
    problems.Add(path, "is given beside a translation or a rotation", "give one of them");
  }
  if (constraint.axes_size() > 0 && constraint.axes_size() != 3) {
    problems.Add(path, "moves all three axes, but not all are constrained", "omit the constraint's axes");
  }
  return bone && skeleton.driven ? static_cast<std::int32_t>(*bone) : -1;
}

}  // namespace

Motion TranslateMotion(const v1::Motion& motion, const std::array<bool, 3>& axes, double metres,
                       const std::string& path, Problems& problems) {
  Motion result;
  TranslateTranslation(motion, axes, path, result, problems);
  if (motion.has_rotation()) {
    result.rotation = TranslateRotation(motion.rotation(), metres, JoinPath(path, "rotation"), problems);
  }
  return result;
}

std::vector<Constraint> TranslateConstraints(const v1::Body& body, const std::string& body_path, const Names& regions,
                                             const TranslatedSkeleton& skeleton, Problems& problems) {
  std::vector<Constraint> result;
  for (int i = 0; i < body.constraints_size(); ++i) {
    const v1::Constraint& constraint = body.constraints(i);
    const std::string path = JoinPath(body_path, IndexPath("constraints", static_cast<std::size_t>(i)));
    Constraint translated;
    const auto region = regions.Find(constraint.region(), JoinPath(path, "region"), problems);
    translated.axes = TranslateAxes(constraint, path, problems);
    const std::string motion_path = JoinPath(path, "motion");
    translated.motion =
        TranslateMotion(constraint.motion(), translated.axes, MetresIn(body.unit()), motion_path, problems);
    if (!constraint.motion().bone().empty()) {
      translated.motion.bone = TranslateBone(constraint, JoinPath(motion_path, "bone"), skeleton, problems);
    }
    if (!region) continue;
    translated.region = static_cast<std::int32_t>(*region);
    result.push_back(std::move(translated));
  }
  return result;
}

}  // namespace fascicle::server
