// Motions of coordinates, placements, strengths of muscles, and activations of a motion.
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <cmath>
#include <cstdio>
#include <random>

#include "core/base/stop.h"
#include "core/skeleton/joint_tree.h"
#include "core/skeleton/motion_activations.h"
#include "core/skeleton/muscle_path.h"
#include "core/skeleton/placement.h"
#include "tests/support/two_bone_arm.h"

namespace fascicle {
namespace {

TEST(LeastJerk, RestsAtEachPointAndItsDerivativesAreContinuous) {
  const std::vector<double> x = {0, 0.5, 2}, y = {1, -2, 3};
  const ScalarFunction f = ScalarFunction::LeastJerk(x, y);
  for (std::size_t k = 0; k < x.size(); ++k) {
    EXPECT_NEAR(f.At(x[k]), y[k], 1e-14);
    for (const double side : {-1e-9, 1e-9}) {
      EXPECT_NEAR(f.At(x[k] + side, 1), 0, 1e-12);
      EXPECT_NEAR(f.At(x[k] + side, 2), 0, 1e-5);
    }
  }
  // The middle of a reach: half of the way at 15/8 of the mean speed [Flash & Hogan 1985].
  EXPECT_NEAR(f.At(0.25), -0.5, 1e-14);
  EXPECT_NEAR(f.At(0.25, 1), -3 / 0.5 * 15 / 8, 1e-12);
}

TEST(CoordinateMotion, IsConstantOutsideOfItsTimes) {
  const CoordinateMotion motion{ScalarFunction::Cubic({1, 2, 3}, {0, 1, 4}), 1, 3};
  EXPECT_EQ(motion.At(0), 0);
  EXPECT_EQ(motion.At(0, 1), 0);
  EXPECT_NEAR(motion.At(5), 4, 1e-14);
  EXPECT_EQ(motion.At(5, 1), 0);
  EXPECT_GT(motion.At(2, 1), 0);
}

TEST(Placement, AnglesAreThoseOfThePose) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> angle(-3, 3), tilt(-1.5, 1.5);
  for (int k = 0; k < 100; ++k) {
    const Vec3 angles(angle(random), tilt(random), angle(random)), position(1, 2, 3);
    const Pose pose = PoseByAngles(position, angles);
    EXPECT_LT((AnglesOf(pose) - angles).norm(), 1e-9);
    const Pose both = pose * pose;
    EXPECT_LT((RotationOf(both) - RotationOf(pose) * RotationOf(pose)).norm(), 1e-14);
    EXPECT_LT((both.position - (position + RotationOf(pose) * position)).norm(), 1e-14);
  }
  const Pose upright = PoseByAngles(Vec3::Zero(), Vec3(0.3, M_PI / 2, 0.4));
  EXPECT_LT((RotationOf(PoseByAngles(Vec3::Zero(), AnglesOf(upright))) - RotationOf(upright)).norm(), 1e-7);
}

TEST(JointTree, CoordinatesMoveWhatIsBeyondTheirJoint) {
  const Skeleton arm = TwoBoneArm();
  const JointTree tree(arm);
  EXPECT_TRUE(tree.Moves(0, 0) && tree.Moves(0, 1) && tree.Moves(1, 1));
  EXPECT_FALSE(tree.Moves(1, 0) || tree.Moves(0, -1));
  EXPECT_TRUE(tree.Parts(1, {0, 1}));
  EXPECT_FALSE(tree.Parts(0, {0, 1}));  // it moves both
  EXPECT_TRUE(tree.Parts(0, {-1, 1}));
}

TEST(MuscleStrength, FollowsTheLengthOfTheFibres) {
  LineMuscle muscle = TwoBoneArm().muscles[0];
  muscle.optimal_fibre_length = 0.1;
  muscle.tendon_slack_length = 0.2;
  EXPECT_EQ(ForceOf(muscle, MuscleStrength::kConstant, 5).active, muscle.max_isometric_force);
  const MuscleForce best = ForceOf(muscle, MuscleStrength::kForceLength, 0.3);
  EXPECT_NEAR(best.active, muscle.max_isometric_force, 1e-9);
  EXPECT_EQ(best.passive, 0);
  const MuscleForce longer = ForceOf(muscle, MuscleStrength::kForceLength, 0.36);
  EXPECT_NEAR(longer.passive, muscle.max_isometric_force, 1e-9);  // at the strain of its definition
  EXPECT_NEAR(longer.active, muscle.max_isometric_force * std::exp(-0.36 / 0.45), 1e-9);
  EXPECT_EQ(ForceOf(muscle, MuscleStrength::kForceLength, 0.19).At(1), 0);  // slack
  muscle.pennation = 0.5;
  const double along = 0.1 * std::cos(0.5);
  EXPECT_NEAR(ForceOf(muscle, MuscleStrength::kForceLength, 0.2 + along).active,
              muscle.max_isometric_force * std::cos(0.5), 1e-9);
}

// Velocities of bones are the derivatives of their poses.
TEST(BoneMotion, VelocitiesAreThoseOfThePoses) {
  SkeletonMechanics mechanics(TwoBoneArm());
  const Eigen::Vector2d q(0.4, 1.1), rates(1.5, -2);
  const std::vector<BoneMotion> now = mechanics.Motions(q, rates);
  constexpr double kStep = 1e-6;
  const std::vector<Pose> later = mechanics.Poses(q + kStep * rates), before = mechanics.Poses(q - kStep * rates);
  for (std::size_t b = 0; b < now.size(); ++b) {
    EXPECT_LT(((later[b].position - before[b].position) / (2 * kStep) - now[b].velocity).norm(), 1e-8);
    const Mat3 spin =
        (RotationOf(later[b]) - RotationOf(before[b])) / (2 * kStep) * RotationOf(now[b].pose).transpose();
    EXPECT_LT((Vec3(spin(2, 1), spin(0, 2), spin(1, 0)) - now[b].angular_velocity).norm(), 1e-8);
  }
}

// A moment on a bone does the work of its rotation.
TEST(GeneralizedForces, OfAMoment) {
  SkeletonMechanics mechanics(TwoBoneArm());
  const Eigen::Vector2d q(0.4, 1.1);
  const Eigen::VectorXd forces = mechanics.GeneralizedForces(q, {{1, Vec3::Zero(), Vec3::Zero(), Vec3(1, 2, 3)}});
  EXPECT_NEAR(forces[0], 3, 1e-12);
  EXPECT_NEAR(forces[1], 3, 1e-12);
}

// The activations of a motion exert its torques, where muscles are strong enough.
TEST(MotionActivations, ExertTheTorques) {
  Skeleton arm = TwoBoneArm();
  SkeletonMechanics mechanics(arm);
  const SkeletonMotion motion{
      {CoordinateMotion::Constant(0.2), {ScalarFunction::LeastJerk({0, 0.5}, {0.6, 1.4}), 0, 0.5}}};
  const std::vector<double> times = {0, 0.1, 0.2, 0.3, 0.4, 0.5};
  const MotionActivations found = ActivationsOf(mechanics, motion, MuscleStrength::kConstant, times, false);
  for (std::size_t k = 0; k < times.size(); ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    const MuscleGeometry geometry = GeometryOf(mechanics, motion.At(times[k]));
    Eigen::VectorXd force(2);
    for (int m = 0; m < 2; ++m) force[m] = found.activations(m, column) * arm.muscles[m].max_isometric_force;
    EXPECT_LT((geometry.moment_arms * force + found.lack.col(column) - found.torques.col(column))[1], 1e-9) << k;
    EXPECT_NEAR(found.lack(1, column), 0, 1e-8) << k;
    EXPECT_EQ(found.lack(0, column), 0) << "no muscle crosses the shoulder";
  }
  // At rest in a pose, the torque is the weight's.
  const MotionActivations at_rest = ActivationsOf(mechanics, motion, MuscleStrength::kConstant, {0.25}, true);
  EXPECT_NEAR(at_rest.torques(1, 0), 2 * 9.81 * 0.15 * std::sin(0.2 + 1.0), 1e-9);
  EXPECT_GT(std::abs(found.torques(1, 1) -
                     ActivationsOf(mechanics, motion, MuscleStrength::kConstant, {0.1}, true).torques(1, 0)),
            0.1);
}

TEST(MotionActivations, TellWhatWeakMusclesLack) {
  Skeleton arm = TwoBoneArm();
  for (LineMuscle& muscle : arm.muscles) muscle.max_isometric_force = 10;
  SkeletonMechanics mechanics(arm);
  const SkeletonMotion motion{{CoordinateMotion::Constant(0), CoordinateMotion::Constant(1.5)}};
  const MotionActivations found = ActivationsOf(mechanics, motion, MuscleStrength::kConstant, {0}, true);
  EXPECT_NEAR(found.activations(0, 0), 1, 1e-6);
  const double arms = GeometryOf(mechanics, motion.At(0)).moment_arms(1, 0);
  EXPECT_NEAR(found.lack(1, 0), found.torques(1, 0) - 10 * arms, 1e-4);
}

TEST(MotionActivations, StopOnRequest) {
  SkeletonMechanics mechanics(TwoBoneArm());
  const SkeletonMotion motion{{CoordinateMotion::Constant(0), CoordinateMotion::Constant(1)}};
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THROW(ActivationsOf(mechanics, motion, MuscleStrength::kConstant, {0}, true, stop.get_token()), Stopped);
}

}  // namespace
}  // namespace fascicle
