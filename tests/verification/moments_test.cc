// Moments of supports: against the torsion of a rod, and against the balance of moments.
#include <gtest/gtest.h>

#include <numbers>

#include "tests/support/brick_bodies.h"
#include "twisted_rod.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;

constexpr double kYoung = 1e5, kPoisson = 0.3;  // [Pa], [1]

// Small torsion of a round rod: M = G (pi r^4 / 2) angle / length.
TEST(MomentsTest, OfATwistedRodIsThatOfSmallStrain) {
  constexpr double kAngle = 1e-3;
  Constraint turn = Fix(kZ1);
  turn.motion.rotation = Rotation{Vec3::Zero(), Vec3::UnitZ(), Ramp(kAngle)};
  Body body = MakeBody("rod", RodMesh(), NeoHookean(std::array{kYoung, kPoisson}));
  body.constraints = {Fix(kZ0), turn};
  Scene scene = StaticScene(std::move(body), ElementOrder::kQuadratic);
  const RunResult run = RunScene(scene);
  ASSERT_EQ(run.outcome.kind, Outcome::Kind::kSucceeded) << run.outcome.failure.message;
  const double shear = kYoung / (2 * (1 + kPoisson));
  const double exact = shear * std::numbers::pi * std::pow(kRodRadius, 4) / 2 * kAngle / kRodLength;
  const double moment = run.Last("rod/moment/z1/z");
  std::printf("moment of the twisted rod %.6g N m, exact %.6g N m, error %.2e\n", moment, exact, moment / exact - 1);
  EXPECT_NEAR(moment, exact, 1e-3 * exact);
  EXPECT_NEAR(run.Last("rod/moment/z0/z"), -moment, 1e-6 * exact);
  for (const char* axis : {"x", "y"}) {
    EXPECT_NEAR(run.Last(std::string("rod/moment/z1/") + axis), 0, 2e-3 * exact);
  }
}

// A force f at the end of a cantilever of length l: the support's moment about a point p balances it, M = -(x - p) x f
// with x the point where the force acts in the deformed body.
TEST(MomentsTest, OfACantileverBalancesItsLoad) {
  for (const ElementOrder order : {ElementOrder::kLinear, ElementOrder::kQuadratic}) {
    Body body = BoxBody(Vec3(0.04, 0.01, 0.01), {4, 1, 1}, NeoHookean(std::array{kYoung, kPoisson}));
    const std::vector<Triangle> surface = BoundaryTriangles(body.tet().mesh);
    body.regions.push_back(SelectRegion(body.tet().mesh, surface, "tip", SphereSelector{Vec3(0.04, 0.01, 0.01), 1e-6}));
    body.constraints = {Fix(kX0)};
    const Vec3 f(0.002, 0.001, -0.005);
    body.loads.push_back({static_cast<std::int32_t>(body.regions.size()) - 1, NodalForce{f}, Ramp(1), {}});
    Scene scene = StaticScene(std::move(body), order);
    const RunResult plain = RunScene(scene);
    const Vec3 p(0.01, -0.02, 0.03), axis = Vec3(1, 2, 2) / 3;
    scene.output.moments = {{0, kX0, p, axis}};
    const RunResult about = RunScene(scene);
    EXPECT_EQ(about.frames.back().bodies[0].positions, plain.frames.back().bodies[0].positions);
    const std::vector<Vec3>& X = scene.bodies[0].nodes();
    const auto tip = static_cast<std::size_t>(scene.bodies[0].regions.back().nodes.at(0));
    ASSERT_EQ(X[tip], Vec3(0.04, 0.01, 0.01));
    const Vec3 x = about.frames.back().bodies[0].positions[tip];
    ASSERT_GT((x - X[tip]).norm(), 1e-4);
    const auto moment_of = [](const RunResult& run) {
      return Vec3(run.Last("box/moment/x0/x"), run.Last("box/moment/x0/y"), run.Last("box/moment/x0/z"));
    };
    EXPECT_LT((moment_of(about) + (x - p).cross(f)).norm(), 1e-10);
    EXPECT_NEAR(about.Last("box/moment/x0/axis"), -axis.dot((x - p).cross(f)), 1e-10);
    EXPECT_LT((moment_of(plain) + (x - Vec3(0, 0.005, 0.005)).cross(f)).norm(), 1e-10);
  }
}

// Linear elasticity is in balance in the rest shape.
TEST(MomentsTest, OfAVoxelCantileverBalancesItsLoad) {
  Body body = VoxelBox(Vec3(0.04, 0.01, 0.01), {8, 2, 2}, LinearElastic(std::array{kYoung, kPoisson}));
  body.constraints = {{0, {true, true, true}, {}}};
  body.loads.push_back({1, Traction{Vec3(0, 0, -5)}, Curve::Constant(1), {}});
  Scene scene = VoxelScene(std::move(body));
  scene.voxel.tolerance = 1e-12;
  const RunResult run = RunScene(scene);
  ASSERT_EQ(run.outcome.kind, Outcome::Kind::kSucceeded) << run.outcome.failure.message;
  const double force = 5 * 1e-4;
  EXPECT_NEAR(run.Last("box/moment/x0/y"), -0.04 * force, 1e-9 * force);
  EXPECT_NEAR(run.Last("box/moment/x0/x"), 0, 1e-9 * force);
}

}  // namespace
}  // namespace fascicle
