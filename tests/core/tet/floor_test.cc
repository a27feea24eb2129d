// Bodies on floors.
#include <gtest/gtest.h>

#include "core/tet/diagnostics.h"
#include "core/tet/floor_contact.h"
#include "tests/support/tet_scenes.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;

const Floor kGround{"ground", Vec3::Zero(), Vec3::UnitZ()};

// A cube of 2 cm above the ground, free.
Scene FallingCube(Stepping stepping, ElementOrder element, double height) {
  Body cube = BoxBody(Vec3(0.02, 0.02, 0.02), {3, 3, 3}, NeoHookean(std::array{2e4, 0.3}), CellsOf(element));
  for (Vec3& x : cube.tet().mesh.nodes) x[2] += height;
  Scene scene;
  scene.bodies = {cube};
  scene.gravity.acceleration = Vec3(0, 0, -9.81);
  scene.floors = {kGround};
  scene.tet.stepping = stepping;
  scene.tet.element = element;
  scene.duration = 0.3;
  scene.output.frame_interval = 0.005;
  return scene;
}

// The floor's force is minus the gradient of its energy.
TEST(FloorTest, ForceIsTheSlopeOfTheEnergy) {
  for (const ElementOrder element : kEveryElement) {
    Scene scene = FallingCube(Stepping::kExplicit, element, 0);
    scene.floors.push_back({"wall", Vec3(0.001, 0, 0), Vec3(1, 0.2, 0).normalized()});
    const TetModel model(scene);
    NodalVector x = model.rest_positions(), direction(x.size());
    for (std::size_t n = 0; n < x.size(); ++n) {
      x[n][2] -= 0.001;
      direction[n] = Vec3(std::sin(3.0 * n), std::cos(5.0 * n), std::sin(7.0 * n + 1));
    }
    NodalVector force(x.size(), Vec3::Zero());
    AddFloorForce(model, x, force);
    const double h = 1e-7;
    NodalVector ahead = x, behind = x;
    double slope = 0;
    for (std::size_t n = 0; n < x.size(); ++n) {
      ahead[n] += h * direction[n];
      behind[n] -= h * direction[n];
      slope += force[n].dot(direction[n]);
    }
    const double difference = (FloorEnergy(model, ahead) - FloorEnergy(model, behind)) / (2 * h);
    EXPECT_NEAR(-slope, difference, 1e-6 * std::abs(slope));
    Vec3 sum = Vec3::Zero(), total = Vec3::Zero();
    for (const Vec3& f : force) sum += f;
    for (const Vec3& f : FloorForces(model, x)) total += f;
    EXPECT_LT((sum - total).norm(), 1e-12 * sum.norm());
    EXPECT_GT(sum[2], 0);
    EXPECT_GT(sum[0], 0);
  }
}

// Falls freely, bounces, and keeps its energy, because there is no damping.
TEST(FloorTest, ABouncingCubeKeepsItsEnergy) {
  for (const ElementOrder element : kEveryElement) {
    Scene scene = FallingCube(Stepping::kExplicit, element, 0.02);
    scene.tet.safety = 0.3;  // a side that hits the ground as a whole is the worst case: 3 % at 0.9
    const RunResult run = RunScene(scene, 2);
    ASSERT_EQ(run.outcome.kind, Outcome::Kind::kSucceeded) << run.outcome.failure.message;
    const double mass = 1060 * 8e-6, fallen = mass * 9.81 * 0.02;
    double lowest = 0, push = 0;
    for (std::size_t k = 0; k < run.frames.size(); ++k) {
      const double sum = run.At(k, "energy/kinetic") + run.At(k, "energy/elastic") + run.At(k, "energy/contact");
      EXPECT_NEAR(sum, run.At(k, "energy/external_work"), 0.01 * fallen) << run.frames[k].time;
      lowest = std::min(lowest, -run.At(k, "energy/external_work"));
      push = std::max(push, run.At(k, "floor/ground/z"));
    }
    EXPECT_LT(lowest, -fallen) << "it reached the ground";
    EXPECT_GT(push, 2 * mass * 9.81);
    // It bounced: most of the fall is regained at some time after the impact at 64 ms.
    double highest = INFINITY;
    for (std::size_t k = 20; k < run.frames.size(); ++k) {
      highest = std::min(highest, run.At(k, "energy/external_work"));
    }
    EXPECT_LT(highest, 0.5 * fallen);
  }
}

// Comes to rest on the floor under its weight, with every stepping that can reach rest.
TEST(FloorTest, TheFloorCarriesTheWeight) {
  const double weight = 1060 * 8e-6 * 9.81;
  for (const Stepping stepping : {Stepping::kExplicit, Stepping::kMixed, Stepping::kBackwardEuler, Stepping::kBdf2}) {
    Scene scene = FallingCube(stepping, ElementOrder::kLinear, 0);
    scene.bodies[0].damping.mass_proportional = 60;
    const RunResult run = RunScene(scene, 2);
    ASSERT_EQ(run.outcome.kind, Outcome::Kind::kSucceeded) << run.outcome.failure.message;
    EXPECT_NEAR(run.Last("floor/ground/z"), weight, 0.01 * weight) << static_cast<int>(stepping);
    EXPECT_LT(run.Last("energy/kinetic"), 1e-3 * weight * 0.001);
  }
}

// Pressed on the floor from above, quasi-statically, with the top free to slide: the forces of floor and support
// balance, and both elements agree.
TEST(FloorTest, PressedInEquilibrium) {
  std::vector<double> push;
  for (const ElementOrder element : kEveryElement) {
    Scene scene = FallingCube(Stepping::kQuasiStatic, element, 0.002);
    scene.gravity.acceleration.setZero();
    Constraint lid = Fix(kZ1);
    lid.motion.translation[2] = Curve{{0, 0.3}, {0, -0.004}};
    scene.bodies[0].constraints = {lid};
    scene.output.frame_interval = 0.03;
    const RunResult run = RunScene(scene, 2);
    ASSERT_EQ(run.outcome.kind, Outcome::Kind::kSucceeded) << run.outcome.failure.message;
    EXPECT_EQ(run.At(4, "floor/ground/z"), 0) << "not there yet";
    push.push_back(run.Last("floor/ground/z"));
    EXPECT_NEAR(run.Last("box/reaction/z1/z"), -push.back(), 1e-6 * push.back());
  }
  // 10 % strain of a cube whose bottom slides, less the penetration of the contact.
  EXPECT_NEAR(push[0], push[1], 0.1 * push[1]);
  EXPECT_GT(push[1], 0.5);
  EXPECT_LT(push[1], 1.2);
}

}  // namespace
}  // namespace fascicle
