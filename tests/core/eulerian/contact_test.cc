// Solids that touch, and grids that travel.
#include <gtest/gtest.h>

#include <cstdio>

#include "tests/support/solids.h"

namespace fascicle::testing {
namespace {

// A ball of 10 cm around a point on a grid that travels with it.
EulerianBody Ball(const Vec3& centre, double spacing, ThreadTeam& team) {
  TriangleMesh surface = CubeSurface(kSide, 8, true);
  for (Vec3& x : surface.nodes) x += centre;
  EulerianGrid grid;
  grid.spacing = spacing;
  for (int d = 0; d < 3; ++d) {
    const double side = kSide / 2 + 4 * spacing;
    grid.origin[d] = spacing * std::floor((centre[d] - side) / spacing);
    grid.cells[d] = static_cast<std::int32_t>(std::ceil((centre[d] + side - grid.origin[d]) / spacing));
  }
  const std::array<double, 2> values = {2e4, 0.3};
  EulerianBody body{grid, SolidShape(surface, spacing / 2, team), NeoHookean(values)};
  body.density = 1000;
  body.volume = VolumeTreatment::kNone;
  body.travels = true;
  return body;
}

struct Balls {
  explicit Balls(ThreadTeam& team, double aside = 0.02)
      : left(Ball(Vec3(-0.055, -aside / 2, 0.001), kSide / 8, team)),
        right(Ball(Vec3(0.055, aside / 2, -0.002), kSide / 8, team)) {
    touching.contacts = {Contact{}};
  }
  // Towards each other.
  void Begin(SolidRun& run, double speed) const {
    run.Begin(0, nullptr, [speed](const Vec3&) { return Vec3(speed, 0, 0); });
    run.Begin(1, nullptr, [speed](const Vec3&) { return Vec3(-speed, 0, 0); });
  }

  EulerianBody left, right;
  Scene touching;
};

// Momentum and its moment about the origin of the world.
Resultant InWorld(const EulerianState& state) {
  const GridFrame frame(state.pose, true);
  const Vec3 momentum = frame.VectorInWorld(state.momentum);
  return {momentum, frame.VectorInWorld(state.moment) + state.pose.position.cross(momentum)};
}

std::string BitsOf(const EulerianWorldState& state) {
  ArchiveWriter archive("test", 1);
  state.Save(archive);
  return archive.Finish();
}

TEST(SurfaceSamples, HaveTheSurfacesAreaAndCentre) {
  const TriangleMesh cube = CubeSurface(2, 1);
  double area = 0;
  Vec3 sum = Vec3::Zero();
  const std::vector<SurfaceSample> samples = SamplesOf(cube, 0.3);
  for (const SurfaceSample& sample : samples) {
    const Triangle& t = cube.triangles[sample.triangle];
    area += 2 * sample.part;
    for (int c = 0; c < 3; ++c) sum += 2 * sample.part * sample.weights[c] * cube.nodes[t[c]];
    EXPECT_GE(sample.weights.minCoeff(), 0);
    EXPECT_NEAR(sample.weights.sum(), 1, 1e-12);
  }
  EXPECT_NEAR(area, 24, 1e-9);
  EXPECT_LT(sum.norm(), 1e-9);
  EXPECT_GT(samples.size(), 12u * 36);
}

// Off centre: they turn. What they exchange is equal and opposite, and what is elastic comes back.
TEST(EulerianContact, BallsBounceAndKeepTheirMomentum) {
  ThreadTeam team(2);
  const Balls balls(team);
  SolidRun run({&balls.left, &balls.right}, team, nullptr, balls.touching);
  balls.Begin(run, 0.5);
  ASSERT_EQ(run.Step(1).problem, StepProblem::kNone);
  const Resultant first[2] = {InWorld(run.state.bodies[0]), InWorld(run.state.bodies[1])};
  double deepest = 0, exchanged = 0;
  while (run.state.time < 0.09) {
    ASSERT_EQ(run.Step(0.09).problem, StepProblem::kNone) << run.state.time;
    deepest = std::max(deepest, run.world.contacts().depths()[0]);
    const Resultant now[2] = {InWorld(run.state.bodies[0]), InWorld(run.state.bodies[1])};
    exchanged = std::max(exchanged, (now[0].sum - first[0].sum).norm());
  }
  const Resultant last[2] = {InWorld(run.state.bodies[0]), InWorld(run.state.bodies[1])};
  const double mass = 1000 * balls.left.shape.volume();
  const auto velocity = [&](int b) { return last[b].sum[0] / run.state.bodies[b].momentum_mass; };
  const Vec3 lost = last[0].sum + last[1].sum - first[0].sum - first[1].sum;
  const Vec3 turned = last[0].moment + last[1].moment - first[0].moment - first[1].moment;
  const double restitution = (velocity(1) - velocity(0)) / 1.0;
  std::printf("restitution %.3f, deepest %.3f cells, momentum off by %.2g of what was exchanged, its moment by %.2g\n",
              restitution, deepest / balls.left.grid.spacing, lost.norm() / exchanged,
              turned.norm() / first[0].moment.norm());
  EXPECT_GT(exchanged, 1.5 * 0.5 * mass);
  EXPECT_GT(restitution, 0.7);
  EXPECT_LT(restitution, 1);
  EXPECT_LT(std::abs(last[0].sum[1] + last[1].sum[1]), 0.01 * std::abs(last[0].sum[1]));
  EXPECT_LT(deepest, 0.5 * balls.left.grid.spacing);
  EXPECT_LT(lost.norm(), 2e-3 * exchanged);
  EXPECT_LT(turned.norm(), 2e-2 * first[0].moment.norm());
}

TEST(EulerianContact, BodiesWithoutContactPassThroughEachOther) {
  ThreadTeam team(2);
  const Balls balls(team, 0);
  SolidRun run({&balls.left, &balls.right}, team);
  balls.Begin(run, 0.5);
  while (run.state.time < 0.05) ASSERT_EQ(run.Step(0.05).problem, StepProblem::kNone);
  EXPECT_NEAR(InWorld(run.state.bodies[0]).sum[0] / run.state.bodies[0].momentum_mass, 0.5, 1e-3);
}

TEST(EulerianContact, TheSameBitsForAnyThreadsAndInAWorldThatIsLoaded) {
  ThreadTeam one(1);
  const Balls balls(one);
  std::string bits[3], half;
  for (const int threads : {1, 2, 3}) {
    ThreadTeam team(threads);
    SolidRun run({&balls.left, &balls.right}, team, nullptr, balls.touching);
    balls.Begin(run, 1);
    for (int k = 0; k < 14; ++k) ASSERT_EQ(run.Step(1).problem, StepProblem::kNone);
    if (threads == 1) half = BitsOf(run.state);
    for (int k = 0; k < 4; ++k) ASSERT_EQ(run.Step(1).problem, StepProblem::kNone);
    EXPECT_GT(run.world.contacts().depths()[0], 0);
    bits[threads - 1] = BitsOf(run.state);
  }
  EXPECT_EQ(bits[0], bits[1]);
  EXPECT_EQ(bits[0], bits[2]);
  SolidRun loaded({&balls.left, &balls.right}, one, nullptr, balls.touching);
  ArchiveReader archive(half, "test", 1);
  loaded.state.Load(archive);
  ASSERT_TRUE(archive.AtEnd());
  for (int k = 0; k < 4; ++k) ASSERT_EQ(loaded.Step(1).problem, StepProblem::kNone);
  EXPECT_EQ(BitsOf(loaded.state), bits[0]);
}

// It comes to rest in the end. The impulse of the floor is that of the weight and of damping, and what the ball had.
TEST(EulerianContact, AFloorStopsABall) {
  ThreadTeam team(2);
  constexpr double kGravity = 10, kDamping = 40, kEnd = 0.25;
  EulerianBody ball = Ball(Vec3(0.002, 0.001, 0.0505), kSide / 8, team);
  ball.gravity = Vec3(0, 0, -kGravity);
  ball.mass_damping = kDamping;
  Scene scene;
  scene.floors = {Floor{"floor", Vec3::Zero(), Vec3::UnitZ()}};
  SolidRun run({&ball}, team, nullptr, scene);
  double deepest = 0;
  Vec3 impulse = Vec3::Zero();
  while (run.state.time < kEnd) {
    ASSERT_EQ(run.Step(kEnd).problem, StepProblem::kNone) << run.state.time;
    deepest = std::max(deepest, run.world.contacts().depths()[0]);
    impulse += run.state.time_step * run.state.floor_forces[0];
  }
  const RigidVelocity rigid = RigidPartOf(ball.grid, run.forces(), run.solid().v, team);
  const double sunk = 0.0505 - GridFrame(run.solid().pose, true).PointInWorld(rigid.centre)[2];
  const double expected = MassOf(run.forces(), team) * (kGravity * kEnd - kDamping * sunk + rigid.linear[2]);
  std::printf("floor: impulse %.4f of what it must be, sunk by %.2f mm, deepest %.3f cells\n", impulse[2] / expected,
              1e3 * sunk, deepest / ball.grid.spacing);
  EXPECT_NEAR(impulse[2], expected, 0.01 * expected);
  EXPECT_LT(impulse.head<2>().norm(), 1e-9 * expected);
  EXPECT_LT(rigid.linear.norm(), 0.01);
  EXPECT_LT(deepest, 0.5 * ball.grid.spacing);
  EXPECT_NEAR(sunk, 0.0084, 0.0025);  // Hertz: 8.4 mm, which is not small
}

// A grid that travels carries its body through any distance, and turns with it: angular velocity and shape last.
TEST(EulerianTravel, ASpinningBallFliesFarWithoutLosingItsSpin) {
  ThreadTeam team(2);
  EulerianBody ball = Ball(Vec3::Zero(), kSide / 8, team);
  ball.implicit_elasticity = true;
  SolidRun run(ball, team);
  const Vec3 spin(0, 0, M_PI), velocity(3, 0, 0);
  run.Begin(0, nullptr, [&](const Vec3& x) { return Vec3(velocity + spin.cross(x)); });
  ASSERT_EQ(run.Step(1.0 / 60).problem, StepProblem::kNone);
  EXPECT_NEAR(run.state.time_step, 1.0 / 60, 1e-12);  // the flight itself limits nothing
  const Resultant first = InWorld(run.solid());
  for (int frame = 2; frame <= 40; ++frame) {
    while (run.state.time < frame / 60.0) ASSERT_EQ(run.Step(frame / 60.0).problem, StepProblem::kNone);
  }
  const GridFrame frame(run.solid().pose, true);
  const RigidVelocity rigid = RigidPartOf(ball.grid, run.forces(), run.solid().v, team);
  const Resultant last = InWorld(run.solid());
  std::printf("spin %.4f of the first, moment of momentum off by %.2g, flown %.4f m in %lld steps\n",
              rigid.spin[2] / M_PI, (last.moment - first.moment).norm() / first.moment.norm(),
              frame.PointInWorld(rigid.centre)[0], static_cast<long long>(run.state.step));
  EXPECT_GT(rigid.spin[2], 0.98 * M_PI);
  EXPECT_LT(rigid.spin[2], M_PI);  // the ball widens
  EXPECT_NEAR(frame.PointInWorld(rigid.centre)[0], 3 * run.state.time, 1e-3);
  EXPECT_LT((last.sum - first.sum).norm(), 2e-3 * first.sum.norm());
  EXPECT_NEAR(VolumeRatio(ball, run.solid()), 1, 2e-3);
}

}  // namespace
}  // namespace fascicle::testing
