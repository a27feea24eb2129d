// Difficult steps of the quasi-static method, all with default settings: large loads and deformations at once.
#include <gtest/gtest.h>

#include <numbers>

#include "tests/support/reference_problems.h"
#include "tests/support/static_run.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;

std::string ElementName(ElementOrder element) { return element == ElementOrder::kLinear ? "linear" : "quadratic"; }

class RobustnessTest : public ::testing::TestWithParam<ElementOrder> {
 protected:
  Scene SceneOf(Body body) const { return StaticScene(std::move(body), GetParam()); }

  // Steps to the end and prints the effort; the final state is in equilibrium without inverted elements.
  static void Finish(SteppedRun& run, const std::string& what) {
    const bool arrived = run.To(1);
    std::printf("%s, %s: %lld steps, %lld iterations, smallest ratio %.3f%s\n", what.c_str(),
                ElementName(run.model.order()).c_str(), static_cast<long long>(run.state.step),
                static_cast<long long>(run.state.iterations), run.state.smallest_ratio, arrived ? "" : ": FAILED");
    ASSERT_TRUE(arrived) << what << " stopped at " << run.state.time;
    EXPECT_LT(run.solver.EquilibriumResidual(run.state), 1e-6) << what;
    EXPECT_GT(run.state.smallest_ratio, 0) << what;
  }
};

TEST_P(RobustnessTest, CantileverAtTwiceItsLoad) {
  SteppedRun run(SceneOf(LockingCantilever(2, Ramp(2))));
  Finish(run, "twice the load of f");
  EXPECT_LT(run.DisplacementAt(kCantileverTip)[2], GetParam() == ElementOrder::kQuadratic ? -0.0065 : -0.005);
}

// All of the activation in the first step.
TEST_P(RobustnessTest, SuddenContraction) {
  SteppedRun run(SceneOf(ReferenceMuscle(4, Curve::Constant(1))));
  Finish(run, "activation from 0 to 1");
  EXPECT_GT(run.Reaction(1)[2], 60);
}

TEST_P(RobustnessTest, Twist) {
  Body body =
      MakeBody("block", MakeBox(Vec3(-0.005, -0.005, 0), Vec3(0.01, 0.01, 0.04), {3, 3, 12}), NearlyIncompressible());
  Constraint turn = Fix(kZ1);
  turn.motion.rotation = Rotation{Vec3::Zero(), Vec3::UnitZ(), Ramp(std::numbers::pi / 2)};
  body.constraints = {Fix(kZ0), turn};
  Scene scene = SceneOf(body);
  scene.tet.time_step = 0.1;  // 9 degrees
  SteppedRun run(scene);
  Finish(run, "twist by 90 degrees");
  EXPECT_EQ(run.state.step, 10);
}

TEST_P(RobustnessTest, CompressedCubes) {
  for (const auto& [name, law] : {std::pair<const char*, Material>{"Mooney-Rivlin", NearlyIncompressible()},
                                  {"neo-Hookean", NeoHookean(std::array{1e5, 0.3})}}) {
    SteppedRun run(SceneOf(ClampedCube(4, law, Ramp(-0.007))));
    Finish(run, std::string("a ") + name + " cube compressed to 30 % of its height");
    EXPECT_LT(run.Reaction(1)[2], 0);
  }
}

INSTANTIATE_TEST_SUITE_P(Elements, RobustnessTest, ::testing::Values(ElementOrder::kLinear, ElementOrder::kQuadratic),
                         [](const auto& element) { return ElementName(element.param); });

}  // namespace
}  // namespace fascicle
