#ifndef FASCICLE_CORE_SKELETON_SKELETON_H_
#define FASCICLE_CORE_SKELETON_SKELETON_H_

#include <array>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "core/base/pose.h"
#include "core/base/types.h"
#include "core/skeleton/line_muscle.h"
#include "core/skeleton/scalar_function.h"
#include "core/skeleton/wrap_surface.h"

namespace fascicle {

// A surface of a bone, in a file: for pictures and contact.
struct BoneSurface {
  std::string file;
  Vec3 scale = Vec3::Ones();
  Pose pose;  // in the bone's frame
};

// A rigid body.
struct Bone {
  std::string name;
  double mass = 0;                  // [kg]
  Vec3 mass_centre = Vec3::Zero();  // in the bone's frame [m]
  Mat3 inertia = Mat3::Zero();      // about the mass centre, in the bone's axes [kg m^2]
  std::vector<BoneSurface> surfaces = {};
};

// A generalized coordinate: an angle [rad] or a distance [m].
struct Coordinate {
  std::string name;
  bool is_angle = true;
  double start = 0;        // default value [rad or m]
  double start_speed = 0;  // [1/s]
  std::array<double, 2> range = {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  bool locked = false;  // keeps its start value
};

// A rotation about an axis, or a translation along it, by a function of a coordinate.
struct MotionAxis {
  Vec3 axis = Vec3::UnitX();  // unit length
  int coordinate = -1;        // -1: none; the function is then constant
  ScalarFunction function = ScalarFunction::Constant(0);
};

// A joint between two bones. Its child's joint frame is displaced from its parent's by three translations along axes of
// the parent's frame, and rotated by the rotations R1 R2 R3 about body-fixed axes [Seth et al. 2010, Minimal
// formulation of joint motion for biomechanisms]. Hinges, sliders, universal, ball, free and welded joints are of this
// kind: those with three rotations are singular where the second one is at 90 degrees.
struct Joint {
  std::string name;
  int parent = kGround, child = 0;  // bones
  Pose in_parent, in_child;         // of the joint's frames, in the bones' frames
  std::array<MotionAxis, 3> rotations, translations;

  static constexpr int kGround = -1;
};

// Bones, their joints and the muscles between them. Each bone is the child of exactly one joint, and joints are sorted
// so that a parent comes before its children.
struct Skeleton {
  std::string name;
  Vec3 gravity = Vec3(0, -9.80665, 0);  // [m/s^2]
  std::vector<Bone> bones;
  std::vector<Joint> joints;
  std::vector<Coordinate> coordinates;
  std::vector<WrapSurface> surfaces;
  std::vector<LineMuscle> muscles;
};

// The index of the coordinate, bone or muscle of a name; -1 if there is none.
template <class Named>
int IndexOf(const std::vector<Named>& list, const std::string& name) {
  for (std::size_t k = 0; k < list.size(); ++k) {
    if (list[k].name == name) return static_cast<int>(k);
  }
  return -1;
}

}  // namespace fascicle

#endif  // FASCICLE_CORE_SKELETON_SKELETON_H_
