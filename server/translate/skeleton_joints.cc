#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "server/translate/skeleton_parts.h"
#include "server/translate/values.h"

namespace fascicle::server {
namespace {

constexpr int kMostCoefficients = 20, kMostPoints = 1000;
// Of axes that are not the same.
constexpr double kLeastSine = 1e-4;

std::string PathOf(const char* list, int index) {
  return JoinPath("skeleton", IndexPath(list, static_cast<std::size_t>(index)));
}

// A body's moments of inertia are those of a distribution of mass.
void CheckInertia(const Bone& bone, const std::string& path, Problems& problems) {
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(bone.inertia, Eigen::EigenvaluesOnly);
  const Vec3 principal = solver.eigenvalues();
  const double slack = 1e-6 * principal.cwiseAbs().maxCoeff();
  if (principal[0] < -slack) {
    problems.Add(JoinPath(path, "inertia"), "has a negative principal moment " + Text(principal[0]) + " kg m^2",
                 "check the signs and the order: xx yy zz xy xz yz");
  } else if (principal[0] + principal[1] < principal[2] - slack) {
    problems.Add(JoinPath(path, "inertia"),
                 "has principal moments " + Text(principal[0]) + ", " + Text(principal[1]) + ", " + Text(principal[2]) +
                     " kg m^2, of which the largest exceeds the sum of the others",
                 "no body has these: check units, and the order xx yy zz xy xz yz");
  }
  if (bone.mass == 0 && bone.inertia.cwiseAbs().maxCoeff() > 0) {
    problems.Add(JoinPath(path, "mass"), "is missing or 0, but there is an inertia", "give both or none of them");
  }
}

void TranslateCoordinates(const v1::Skeleton& wire, Skeleton& skeleton, Problems& problems) {
  for (int i = 0; i < wire.coordinates_size(); ++i) {
    const v1::Coordinate& from = wire.coordinates(i);
    Coordinate coordinate;
    coordinate.name = from.name();
    coordinate.start = from.value();
    coordinate.locked = from.locked();
    if (from.range_size() == 2) {
      coordinate.range = {from.range(0), from.range(1)};
      if (!(from.range(0) < from.range(1))) {
        problems.Add(JoinPath(PathOf("coordinates", i), "range"), "does not ascend", "the lowest value first");
      }
    }
    skeleton.coordinates.push_back(std::move(coordinate));
  }
}

// Reads the joints one after the other; each coordinate belongs to one of them.
class JointReader {
 public:
  JointReader(const SkeletonNames& names, Skeleton& skeleton, Problems& problems)
      : names_(names), skeleton_(skeleton), problems_(problems), joint_of_(skeleton.coordinates.size(), -1) {}

  Joint Read(const v1::Joint& wire, int number) {
    const std::string path = PathOf("joints", number);
    Joint joint;
    joint.name = wire.name();
    joint.parent = names_.BoneOrGround(wire.parent(), JoinPath(path, "parent"), problems_);
    const auto child = names_.bones.Find(wire.child(), JoinPath(path, "child"), problems_);
    joint.child = child ? static_cast<int>(*child) : -1;
    joint.in_parent = ToPose(wire.in_parent());
    joint.in_child = ToPose(wire.in_child());
    ReadAxes(wire.rotations(), number, JoinPath(path, "rotations"), true, joint.rotations);
    ReadAxes(wire.translations(), number, JoinPath(path, "translations"), false, joint.translations);
    return joint;
  }

  void CheckUse(const v1::Skeleton& wire) {
    for (std::size_t c = 0; c < joint_of_.size(); ++c) {
      if (joint_of_[c] >= 0) continue;
      problems_.Add(PathOf("coordinates", static_cast<int>(c)),
                    "`" + wire.coordinates(static_cast<int>(c)).name() + "` moves no joint",
                    "name it in the axes of a joint, or remove it");
    }
  }

 private:
  using Axes = std::array<MotionAxis, 3>;

  void ReadAxes(const google::protobuf::RepeatedPtrField<v1::JointAxis>& wire, int joint, const std::string& path,
                bool turns, Axes& axes) {
    CheckCount(wire.size(), 3, path, problems_);
    const int count = std::min(wire.size(), 3);
    for (int k = 0; k < count; ++k) {
      const std::string axis_path = path + IndexPath("", static_cast<std::size_t>(k));
      MotionAxis& axis = axes[static_cast<std::size_t>(k)];
      axis.axis = ToDirection(wire[k].axis(), JoinPath(axis_path, "axis"), problems_);
      for (int before = 0; before < k; ++before) {
        if (axes[static_cast<std::size_t>(before)].axis.cross(axis.axis).norm() > kLeastSine) continue;
        problems_.Add(JoinPath(axis_path, "axis"), "is the same as the axis of an earlier entry",
                      "a rotation or a translation twice along one axis is singular: join them");
      }
      ReadMotion(wire[k], joint, axis_path, turns, axis);
    }
    FillAxes(count, axes);
  }

  void ReadMotion(const v1::JointAxis& wire, int joint, const std::string& path, bool turns, MotionAxis& axis) {
    if (wire.has_function()) axis.function = TranslateFunction(wire.function(), JoinPath(path, "function"), problems_);
    if (wire.coordinate().empty()) {
      if (!wire.has_function()) {
        problems_.Add(path, "has neither a coordinate nor a function", "name a coordinate");
      }
      return;
    }
    if (!wire.has_function()) axis.function = ScalarFunction::Identity();
    axis.coordinate = names_.Coordinate(wire.coordinate(), JoinPath(path, "coordinate"), problems_);
    if (axis.coordinate < 0) return;
    const auto index = static_cast<std::size_t>(axis.coordinate);
    Coordinate& coordinate = skeleton_.coordinates[index];
    coordinate.is_angle = turns || (joint_of_[index] >= 0 && coordinate.is_angle);
    if (joint_of_[index] >= 0 && joint_of_[index] != joint) {
      problems_.Add(JoinPath(path, "coordinate"), "`" + wire.coordinate() + "` moves another joint, too",
                    "give each joint coordinates of its own");
    }
    joint_of_[index] = joint;
  }

  // Unused axes are independent of the used ones.
  static void FillAxes(int count, Axes& axes) {
    if (count == 0) {
      for (int k = 0; k < 3; ++k) axes[static_cast<std::size_t>(k)].axis = Vec3::Unit(k);
    }
    if (count == 1) axes[1].axis = axes[0].axis.unitOrthogonal();
    if (count == 1 || count == 2) axes[2].axis = axes[0].axis.cross(axes[1].axis).normalized();
  }

  const SkeletonNames& names_;
  Skeleton& skeleton_;
  Problems& problems_;
  std::vector<int> joint_of_;  // of each coordinate
};

// Sorts joints so that parents come before children. Each bone is the child of one joint.
void SortJoints(const std::vector<Joint>& joints, Skeleton& skeleton, Problems& problems) {
  std::vector<int> joint_of(skeleton.bones.size(), -1);
  bool twice = false;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    if (joints[j].child < 0) return;
    int& own = joint_of[static_cast<std::size_t>(joints[j].child)];
    if (own >= 0) {
      twice = true;
      problems.Add(JoinPath(PathOf("joints", static_cast<int>(j)), "child"),
                   "`" + skeleton.bones[static_cast<std::size_t>(joints[j].child)].name + "` is the child of " +
                       IndexPath("joints", static_cast<std::size_t>(own)) + ", too",
                   "each bone is the child of one joint; loops of joints are not supported");
    }
    own = static_cast<int>(j);
  }
  std::vector<bool> placed(skeleton.bones.size());
  for (bool found = true; found && !twice;) {
    found = false;
    for (std::size_t b = 0; b < placed.size(); ++b) {
      if (placed[b] || joint_of[b] < 0) continue;
      const Joint& joint = joints[static_cast<std::size_t>(joint_of[b])];
      if (joint.parent >= 0 && !placed[static_cast<std::size_t>(joint.parent)]) continue;
      skeleton.joints.push_back(joint);
      placed[b] = found = true;
    }
  }
  for (std::size_t b = 0; b < placed.size() && !twice; ++b) {
    if (placed[b]) continue;
    problems.Add(
        PathOf("bones", static_cast<int>(b)), "no joints connect `" + skeleton.bones[b].name + "` with the ground",
        joint_of[b] < 0 ? "give it a joint; one to the ground without axes fixes it" : "its joints form a loop");
  }
}

}  // namespace

int SkeletonNames::BoneOrGround(const std::string& name, const std::string& path, Problems& problems) const {
  if (name.empty()) return Joint::kGround;
  const auto bone = bones.Find(name, path, problems);
  return bone ? static_cast<int>(*bone) : Joint::kGround;
}

int SkeletonNames::Coordinate(const std::string& name, const std::string& path, Problems& problems) const {
  const auto coordinate = coordinates.Find(name, path, problems);
  return coordinate ? static_cast<int>(*coordinate) : -1;
}

ScalarFunction TranslateFunction(const v1::CoordinateFunction& wire, const std::string& path, Problems& problems) {
  const bool has_points = wire.x_size() > 0 || wire.y_size() > 0;
  if (has_points == (wire.coefficients_size() > 0)) {
    problems.Add(path, has_points ? "has both coefficients and points" : "is empty",
                 "give coefficients, or points by x and y");
    return ScalarFunction::Constant(0);
  }
  Problems own;
  if (!has_points) {
    CheckCount(wire.coefficients_size(), kMostCoefficients, JoinPath(path, "coefficients"), problems);
    return ScalarFunction::Polynomial({wire.coefficients().begin(), wire.coefficients().end()});
  }
  CheckCount(wire.x_size(), kMostPoints, JoinPath(path, "x"), own);
  if (wire.x_size() != wire.y_size()) {
    own.Add(JoinPath(path, "y"),
            "has " + std::to_string(wire.y_size()) + " values for " + std::to_string(wire.x_size()) + " values of x",
            "one for each");
  }
  if (wire.x_size() < 2) own.Add(JoinPath(path, "x"), "has fewer than two points", "coefficients give constants");
  for (int k = 1; k < wire.x_size(); ++k) {
    if (wire.x(k) > wire.x(k - 1)) continue;
    own.Add(JoinPath(path, IndexPath("x", static_cast<std::size_t>(k))), "does not increase",
            "x must increase strictly");
    break;
  }
  problems.Append("", own);
  if (!own.empty()) return ScalarFunction::Constant(0);
  std::vector<double> x(wire.x().begin(), wire.x().end()), y(wire.y().begin(), wire.y().end());
  return wire.curve() == v1::FUNCTION_CURVE_LINEAR ? ScalarFunction::PiecewiseLinear(std::move(x), std::move(y))
                                                   : ScalarFunction::Cubic(std::move(x), std::move(y));
}

void TranslateBones(const v1::Skeleton& wire, Skeleton& skeleton, Problems& problems) {
  for (int i = 0; i < wire.bones_size(); ++i) {
    const v1::Bone& from = wire.bones(i);
    Bone bone;
    bone.name = from.name();
    bone.mass = from.mass();
    bone.mass_centre = ToVec3(from.mass_centre());
    const auto& c = from.inertia();
    if (c.size() == 6) bone.inertia << c[0], c[3], c[4], c[3], c[1], c[5], c[4], c[5], c[2];
    CheckInertia(bone, PathOf("bones", i), problems);
    if (bone.name == "ground") {
      problems.Add(JoinPath(PathOf("bones", i), "name"), "is the name of what does not move", "give another name");
    }
    skeleton.bones.push_back(std::move(bone));
  }
  TranslateCoordinates(wire, skeleton, problems);
}

void TranslateJoints(const v1::Skeleton& wire, const SkeletonNames& names, Skeleton& skeleton, Problems& problems) {
  JointReader reader(names, skeleton, problems);
  std::vector<Joint> joints;
  for (int i = 0; i < wire.joints_size(); ++i) joints.push_back(reader.Read(wire.joints(i), i));
  reader.CheckUse(wire);
  SortJoints(joints, skeleton, problems);
}

}  // namespace fascicle::server
