// Runs that begin in equilibrium, or where another run ended.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "core/tet/diagnostics.h"
#include "tests/support/static_run.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;

constexpr Stepping kSteppings[] = {Stepping::kExplicit, Stepping::kMixed, Stepping::kBackwardEuler, Stepping::kNewmark,
                                   Stepping::kBdf2};
constexpr double kLength = 0.06;  // [m]

// An active muscle that is bent by a traction at its end, 200 N/m^2 and activation 0.3 times `curve`.
Scene BentMuscle(const Curve& curve, ElementOrder element) {
  Body body = BoxBody(Vec3(kLength, 0.02, 0.02), {6, 2, 2}, Muscle(std::array{5e3, 5e3, 1e6, 1e5, 1.2, 0.05, 6.6, 1.4}),
                      CellsOf(element));
  body.constraints = {Fix(kX0)};
  body.loads.push_back({kX1, Traction{Vec3(0, 0, -200)}, curve, {}});
  body.activation = curve;
  for (double& value : body.activation.values) value *= 0.3;
  return StaticScene(std::move(body), element);
}

// The same with everything constant, at rest where the static run ended.
Scene AfterStatic(ElementOrder element, Stepping stepping, const RunResult& run,
                  const std::vector<HigherOrderNodes>& layout) {
  Scene scene = BentMuscle(Curve::Constant(1), element);
  scene.tet.stepping = stepping;
  scene.start.frame = true;
  const BodyFrame& end = run.frames.back().bodies[0];
  std::vector<Vec3>& u = scene.bodies[0].tet().initial_displacement;
  for (std::size_t n = 0; n < end.positions.size(); ++n) u.push_back(end.positions[n] - scene.bodies[0].nodes()[n]);
  for (std::size_t n = 0; n < end.higher_order_positions.size(); ++n) {
    u.push_back(end.higher_order_positions[n] - layout[0].positions[n]);
  }
  return scene;
}

// Steps 100 times, and returns how far a node moves [m].
double MotionIn100Steps(SteppedRun& run, double dt) {
  const NodalVector start = run.state.positions;
  const bool own_step = run.scene.tet.stepping == Stepping::kExplicit || run.scene.tet.stepping == Stepping::kMixed;
  for (int k = 0; k < 100; ++k) {
    const double end = own_step ? 1000 : (k + 1) * dt;
    EXPECT_EQ(run.solver.Advance(run.state, end).problem, StepProblem::kNone);
  }
  EXPECT_EQ(run.state.step, 100);
  return LargestDifference(run.state.positions, start);
}

class StartOfElementTest : public ::testing::TestWithParam<ElementOrder> {};

// Frames have all nodes, so a static result is an equilibrium of dynamic runs, too.
TEST_P(StartOfElementTest, NothingMovesAfterAStaticRun) {
  const Scene scene = BentMuscle(Ramp(1), GetParam());
  const RunResult run = RunScene(scene);
  ASSERT_EQ(run.outcome.kind, Outcome::Kind::kSucceeded);
  const std::vector<HigherOrderNodes> layout = Simulation(std::make_shared<Scene>(scene), 1).layout().higher_order;
  for (const Stepping stepping : kSteppings) {
    SteppedRun dynamic(AfterStatic(GetParam(), stepping, run, layout));
    double moved = 0;
    for (const Vec3& x : run.frames.back().bodies[0].positions) moved = std::max(moved, -x.z());
    ASSERT_GT(moved, 1e-3) << "the static load bends the muscle";
    const double residual = dynamic.solver.EquilibriumResidual(dynamic.state);
    const double motion = MotionIn100Steps(dynamic, 1e-3);
    std::printf("stepping %d: residual %.1e, motion in 100 steps %.1e m\n", static_cast<int>(stepping), residual,
                motion);
    EXPECT_LT(residual, 1e-8);
    EXPECT_LT(motion, 1e-8 * kLength);
  }
}

// The same equilibrium, found before the first step.
TEST_P(StartOfElementTest, AnyRunCanStartInEquilibrium) {
  SteppedRun reference(BentMuscle(Ramp(1), GetParam()));
  ASSERT_TRUE(reference.To(1));
  for (const Stepping stepping : kSteppings) {
    Scene scene = BentMuscle(Curve::Constant(1), GetParam());
    scene.tet.stepping = stepping;
    scene.start.equilibrium = true;
    scene.output.frame_interval = scene.duration = 1e-3;
    const RunResult run = RunScene(scene);
    ASSERT_EQ(run.outcome.kind, Outcome::Kind::kSucceeded);
    for (const Frame& frame : run.frames) {
      EXPECT_LT(LargestDifference(frame.bodies[0].positions,
                                  NodalVector(reference.state.positions.begin(),
                                              reference.state.positions.begin() +
                                                  static_cast<std::ptrdiff_t>(frame.bodies[0].positions.size()))),
                1e-7 * kLength);
    }
    EXPECT_LT(run.Last("energy/kinetic"), 1e-12 * std::abs(run.Last("energy/elastic")));
  }
}
INSTANTIATE_TEST_SUITE_P(Elements, StartOfElementTest,
                         ::testing::Values(ElementOrder::kLinear, ElementOrder::kQuadratic, ElementOrder::kHexahedral));

// Frame 0 of a quasi-static run is a state of rest otherwise.
TEST(StartTest, AQuasiStaticRunHasTheEquilibriumInItsFirstFrame) {
  Scene scene = BentMuscle(Curve::Constant(1), ElementOrder::kQuadratic);
  const double at_rest = RunScene(scene).At(0, "energy/elastic");
  scene.start.equilibrium = true;
  const RunResult run = RunScene(scene);
  EXPECT_LT(std::abs(at_rest), 1e-12 * std::abs(run.Last("energy/elastic")));
  EXPECT_NEAR(run.At(0, "energy/elastic") / run.Last("energy/elastic"), 1, 1e-9);
}

// A support that is displaced at time 0 by more than an element takes several parts.
TEST(StartTest, LargeLoadsAreAppliedInParts) {
  Scene scene = BentMuscle(Curve::Constant(1), ElementOrder::kLinear);
  Motion motion;
  motion.translation[2] = Curve::Constant(-0.03);
  scene.bodies[0].constraints.push_back(Fix(kX1));
  scene.bodies[0].constraints.back().motion = motion;
  scene.bodies[0].loads.clear();
  scene.tet.stepping = Stepping::kNewmark;
  scene.start.equilibrium = true;
  SteppedRun run(scene);
  ThreadTeam team(1);
  TetSolver solver(run.model, team);
  ControlSource source(run.scene);
  Controls start;
  source.Evaluate(0, start);
  TetState state = solver.InitialState(start);
  ASSERT_EQ(solver.SolveEquilibrium(start, state).problem, StepProblem::kNone);
  EXPECT_LT(EquilibriumResidual(run.model, state, start, team), 1e-8);
  EXPECT_NEAR(state.positions[run.NodeAt(Vec3(kLength, 0.01, 0.01))].z(), 0.01 - 0.03, 1e-15);
  EXPECT_EQ(LargestNorm(state.velocities), 0);
}

// A law that collapses under this load has no equilibrium: the run fails, and says why.
TEST(StartTest, FailsWithoutAnEquilibrium) {
  Scene scene = BentMuscle(Curve::Constant(1), ElementOrder::kLinear);
  scene.bodies[0].material = StVenantKirchhoff(std::array{1e4, 0.3});
  scene.bodies[0].loads[0].kind = Traction{Vec3(-3e5, 0, 0)};
  scene.start.equilibrium = true;
  const RunResult run = RunScene(scene);
  EXPECT_EQ(run.outcome.kind, Outcome::Kind::kFailed);
  EXPECT_EQ(run.outcome.failure.time, 0);
  EXPECT_TRUE(run.frames.empty());
}

// A body thrown with a velocity at all of its nodes flies without deforming.
TEST(StartTest, InitialVelocitiesAreThoseOfAllNodes) {
  for (const Stepping stepping : kSteppings) {
    Body body = BoxBody(Vec3(0.02, 0.02, 0.02), {2, 2, 2}, NeoHookean(std::array{1e4, 0.3}));
    body.tet().initial_velocity.assign(body.nodes().size(), Vec3(1, 2, 3));
    Scene scene = StaticScene(std::move(body), ElementOrder::kQuadratic);
    scene.tet.stepping = stepping;
    scene.output.frame_interval = scene.duration = 0.01;
    scene.output.fields = {OutputField::kVelocity};
    const RunResult run = RunScene(scene);
    ASSERT_EQ(run.outcome.kind, Outcome::Kind::kSucceeded);
    const BodyFrame &first = run.frames.front().bodies[0], &last = run.frames.back().bodies[0];
    const std::size_t nodes = first.positions.size() + first.higher_order_positions.size();
    ASSERT_EQ(first.fields[0].all_values.size(), 3 * nodes);
    for (std::size_t n = 0; n < nodes; ++n) {
      EXPECT_EQ(Vec3(&first.fields[0].all_values[3 * n]), Vec3(1, 2, 3));
      EXPECT_NEAR((Vec3(&last.fields[0].all_values[3 * n]) - Vec3(1, 2, 3)).norm(), 0, 1e-9);
    }
    for (std::size_t n = 0; n < first.higher_order_positions.size(); ++n) {
      const Vec3 moved = last.higher_order_positions[n] - first.higher_order_positions[n];
      EXPECT_NEAR((moved - 0.01 * Vec3(1, 2, 3)).norm(), 0, 1e-10);
    }
  }
}

// The volume of the ten-node tetrahedra of a frame is the series; that of their corners is 1 % off.
TEST(HigherOrderNodesTest, FramesHaveTheVolumeOfTheSolution) {
  const Scene scene = BentMuscle(Ramp(1), ElementOrder::kQuadratic);
  const RunResult run = RunScene(scene);
  Simulation simulation(std::make_shared<Scene>(scene), 1);
  const std::vector<HigherOrderNodes>& layout = simulation.layout().higher_order;
  ASSERT_EQ(layout.size(), 1u);
  const TetMesh& mesh = scene.bodies[0].tet().mesh;
  ASSERT_EQ(layout[0].of_elements.size(), 6 * mesh.tetrahedra.size());
  const BodyFrame& frame = run.frames.back().bodies[0];
  std::vector<Vec3> x = frame.positions;
  x.insert(x.end(), frame.higher_order_positions.begin(), frame.higher_order_positions.end());
  double volume = 0;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    std::array<Vec3, 10> nodes;
    for (std::size_t a = 0; a < 4; ++a) nodes[a] = x[static_cast<std::size_t>(mesh.tetrahedra[t][a])];
    for (std::size_t a = 0; a < 6; ++a) nodes[4 + a] = x[static_cast<std::size_t>(layout[0].of_elements[6 * t + a])];
    for (int q = 0; q < 4; ++q) {
      std::array<double, 4> L = {kFarCorner, kFarCorner, kFarCorner, kFarCorner};
      L[static_cast<std::size_t>(q)] = kNearCorner;
      const std::array<Vec3, 4> y = CornersAt(nodes, L);
      volume += (y[1] - y[0]).cross(y[2] - y[0]).dot(y[3] - y[0]) / 24;
    }
  }
  EXPECT_NEAR(volume / (kLength * 0.02 * 0.02), run.Last("box/volume_ratio"), 1e-12);
  // At rest a mid-edge node is in the middle, and regions have those between their nodes.
  const Region& wall = scene.bodies[0].regions[kX0];
  ASSERT_EQ(layout[0].of_regions.size(), 6u);
  EXPECT_EQ(layout[0].of_regions[kX0].size(), 2u * 3 + 2 * 3 + 4);
  for (const std::int32_t n : layout[0].of_regions[kX0]) {
    EXPECT_EQ(layout[0].positions[static_cast<std::size_t>(n) - mesh.nodes.size()].x(), 0);
  }
  EXPECT_EQ(wall.nodes.size(), 9u);
}

// Forces on the nodes themselves add up to what those counted at the corners do.
TEST(HigherOrderNodesTest, ForcesAreOnAllNodes) {
  Scene scene = BentMuscle(Ramp(1), ElementOrder::kQuadratic);
  scene.output.fields = {OutputField::kReactionForce, OutputField::kFibreStretch};
  const RunResult run = RunScene(scene);
  const std::vector<FieldValues>& fields = run.frames.back().bodies[0].fields;
  const auto sum = [](const std::vector<double>& values) {
    Vec3 total = Vec3::Zero();
    for (std::size_t i = 0; i < values.size(); i += 3) total += Vec3(&values[i]);
    return total;
  };
  EXPECT_GT(fields[0].all_values.size(), 4 * fields[0].values.size());
  EXPECT_NEAR((sum(fields[0].all_values) - Vec3(0, 0, 200 * 0.02 * 0.02)).norm(), 0, 1e-9);
  EXPECT_NEAR((sum(fields[0].values) - sum(fields[0].all_values)).norm(), 0, 1e-12);
  EXPECT_TRUE(fields[1].all_values.empty());
}

// Frames without higher-order nodes keep their digest; all numbers at these nodes are covered by it.
TEST(HigherOrderNodesTest, AreInTheDigestIfThereAreAny) {
  Frame frame;
  frame.bodies = {{{Vec3(1, 2, 3)}, {{"velocity", FieldLocation::kNode, 3, "m/s", {1, 2, 3}}}}};
  const Digest before = DigestOf(frame);
  frame.bodies[0].higher_order_positions = {Vec3(4, 5, 6)};
  const Digest with = DigestOf(frame);
  EXPECT_NE(with, before);
  frame.bodies[0].fields[0].all_values = {1, 2, 3, 4, 5, 6};
  EXPECT_NE(DigestOf(frame), with);
}

}  // namespace
}  // namespace fascicle
