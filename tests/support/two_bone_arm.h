#ifndef FASCICLE_TESTS_SUPPORT_TWO_BONE_ARM_H_
#define FASCICLE_TESTS_SUPPORT_TWO_BONE_ARM_H_

#include "core/skeleton/skeleton.h"

namespace fascicle {

// An upper arm that hangs along -y from the origin and a forearm of 2 kg, with hinges about z at 0 and 0.3 m below. A
// flexor and an extensor of the elbow.
inline Skeleton TwoBoneArm() {
  Skeleton arm;
  arm.gravity = Vec3(0, -9.81, 0);
  arm.bones = {{"humerus", 1.5, Vec3(0, -0.15, 0), Vec3(0.01, 0.002, 0.01).asDiagonal()},
               {"forearm", 2, Vec3(0, -0.15, 0), Vec3(0.02, 0.002, 0.02).asDiagonal()}};
  arm.coordinates.resize(2);
  arm.coordinates[0].name = "shoulder";
  arm.coordinates[1].name = "elbow";
  for (int j = 0; j < 2; ++j) {
    Joint joint;
    joint.name = arm.coordinates[static_cast<std::size_t>(j)].name;
    joint.parent = j - 1;
    joint.child = j;
    if (j == 1) joint.in_parent.position = Vec3(0, -0.3, 0);
    joint.rotations[0] = {Vec3::UnitZ(), j, ScalarFunction::Identity()};
    joint.rotations[1].axis = Vec3::UnitX();
    joint.rotations[2].axis = Vec3::UnitY();
    for (int k = 0; k < 3; ++k) joint.translations[static_cast<std::size_t>(k)].axis = Vec3::Unit(k);
    arm.joints.push_back(joint);
  }
  const auto muscle = [](const char* name, const Vec3& origin, const Vec3& insertion) {
    LineMuscle line;
    line.name = name;
    line.points.resize(2);
    line.points[0].bone = 0;
    line.points[0].place = origin;
    line.points[1].bone = 1;
    line.points[1].place = insertion;
    line.max_isometric_force = 800;
    return line;
  };
  arm.muscles = {muscle("flexor", Vec3(0.02, -0.05, 0), Vec3(0.01, -0.05, 0)),
                 muscle("extensor", Vec3(-0.02, -0.05, 0), Vec3(-0.025, 0.01, 0))};
  return arm;
}

}  // namespace fascicle

#endif  // FASCICLE_TESTS_SUPPORT_TWO_BONE_ARM_H_
