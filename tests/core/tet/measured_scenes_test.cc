// The scenes of tests/bench are valid and step without problems.
#include <gtest/gtest.h>

#include "tests/support/isometric_muscle.h"
#include "tests/support/static_run.h"
#include "tests/support/tet_box.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;

void ExpectValid(const Scene& scene) {
  Problems problems;
  CheckScene(scene, problems);
  EXPECT_TRUE(problems.empty()) << problems.ToString();
}

TEST(MeasuredScenes, TheBoxIsValid) {
  const TetBox box(2, Muscle(kMuscle), VolumeForm::kNodal);
  ExpectValid(box.scene);
  EXPECT_EQ(box.model.elements(), 6u * 2 * 2 * 2);
  EXPECT_GT(VolumeRatiosOf(box.model, 0, box.Bent()).smallest, 0.5) << "bent, but not crushed";
}

// The whole box falls freely, except for the effect of the support.
TEST(MeasuredScenes, TheFallingBoxFalls) {
  SteppedRun run(FallingBox(4));
  ExpectValid(run.scene);
  ASSERT_TRUE(run.To(0.01));
  const double free_fall = -9.81 * 0.01 * 0.01;  // of one step of backward Euler
  EXPECT_NEAR(run.DisplacementAt(Vec3(0.1, 0.05, 0.05))[2], free_fall, 0.05 * -free_fall);
  EXPECT_EQ(run.DisplacementAt(Vec3(0, 0.05, 0.05)), Vec3::Zero());
}

TEST(MeasuredScenes, TheIsometricMusclePulls) {
  SteppedRun run(IsometricMuscle(kMuscleGrids[0]));
  ExpectValid(run.scene);
  EXPECT_EQ(run.FreeComponents(), static_cast<std::size_t>(kMuscleGrids[0].FreeComponents()));
  EXPECT_EQ(run.model.elements(), static_cast<std::size_t>(kMuscleGrids[0].Tetrahedra()));
  ASSERT_TRUE(run.To(0.3));
  EXPECT_NEAR(run.Reaction(1)[2], 25.2, 0.04 * 25.2);  // [N] on the finest grid; this one, the coarsest, is 3 % off
}

}  // namespace
}  // namespace fascicle
