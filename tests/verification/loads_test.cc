// Pressures, body forces and springs against closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/tet/diagnostics.h"
#include "tests/support/static_run.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;

constexpr double kInner = 0.01, kOuter = 0.015;  // radii [m]
constexpr double kShear = 1e4;                   // [Pa]

// The pressure that inflates an incompressible neo-Hookean tube in plane strain to the inner radius a [Ogden 1997,
// 5.3]: the integral of (sigma_theta - sigma_r) dr / r with sigma_theta - sigma_r = mu (r^2/R^2 - R^2/r^2) and r^2 =
// R^2 + c.
double PressureInTube(double a) {
  const double c = a * a - kInner * kInner, b = std::sqrt(kOuter * kOuter + c);
  return kShear * (std::log(kOuter / kInner) - std::log(b / a) + c / 2 * (1 / (a * a) - 1 / (b * b)));
}

// A quarter of a tube around z between planes of symmetry: regions x0, y0, z0, z1, and `inside` (6).
Body QuarterTube(int across, int around) {
  TetMesh mesh = MakeBox(Vec3::Zero(), Vec3(1, 1, 1), {across, around, 1});
  for (Vec3& X : mesh.nodes) {
    const double r = kInner + (kOuter - kInner) * X[0], angle = std::numbers::pi / 2 * X[1];
    X = Vec3(r * std::cos(angle), r * std::sin(angle), 0.002 * X[2]);
  }
  Body body = MakeBody("tube", std::move(mesh), MooneyRivlin(std::array{kShear / 2, 0.0, 1e4 * kShear}));
  const std::vector<Vec3>& X = body.tet().mesh.nodes;
  Region inside;
  inside.name = "inside";
  for (const Triangle& t : BoundaryTriangles(body.tet().mesh)) {
    const auto is_inner = [&](std::int32_t n) { return X[n].head<2>().norm() < kInner * (1 + 1e-9); };
    if (is_inner(t[0]) && is_inner(t[1]) && is_inner(t[2])) inside.triangles.push_back(t);
  }
  for (std::size_t n = 0; n < X.size(); ++n) {
    if (X[n].head<2>().norm() < kInner * (1 + 1e-9)) inside.nodes.push_back(static_cast<std::int32_t>(n));
  }
  body.regions.push_back(std::move(inside));
  body.constraints = {Fix(kX0, {true, false, false}), Fix(kY0, {false, true, false}), Fix(kZ0, {false, false, true}),
                      Fix(kZ1, {false, false, true})};
  return body;
}

Load PressureOn(std::int32_t region, double value) {
  Load load;
  load.region = region;
  load.kind = Pressure{value};
  load.scale = Ramp(1);
  return load;
}

// A dead load in place of the pressure would miss by far: the inner surface grows by 40 %.
TEST(PressureTest, InflatesATubeAsTheClosedFormSays) {
  const double a = 1.4 * kInner;
  double error_before = 0;
  for (const int across : {2, 4}) {
    Body body = QuarterTube(across, 4 * across);
    body.loads = {PressureOn(6, PressureInTube(a))};
    SteppedRun run(StaticScene(std::move(body), ElementOrder::kQuadratic));
    ASSERT_TRUE(run.To(1));
    const double found = run.state.positions[run.NodeAt(Vec3(kInner, 0, 0))].x();
    const double error = found / a - 1;
    std::printf("tube, %d elements across: inner radius %.6f mm, exact %.6f mm, %+.3f %%; %lld iterations\n", across,
                1e3 * found, 1e3 * a, 100 * error, static_cast<long long>(run.state.iterations));
    if (error_before != 0) {
      EXPECT_LT(std::abs(error), 0.005);
      EXPECT_LT(std::abs(error), 0.4 * error_before);
    }
    error_before = std::abs(error);
    EXPECT_LT(run.solver.EquilibriumResidual(run.state), 1e-6);
  }
}

// A strip bent by a pressure on its free face, whose rim is free: the force has no potential. The equilibrium is that
// of the final shape, and the pressure is normal to it.
TEST(PressureTest, FollowsAStripWithAFreeRim) {
  for (const ElementOrder element : kEveryElement) {
    Body body = BoxBody(Vec3(0.04, 0.005, 0.002), {16, 2, 2}, NeoHookean(std::array{1e5, 0.3}), CellsOf(element));
    body.constraints = {Fix(kX0)};
    // Linear elements and hexahedra are stiffer in bending.
    body.loads = {PressureOn(kZ0, element == ElementOrder::kQuadratic ? 2 : 6)};
    SteppedRun run(StaticScene(std::move(body), element));
    ASSERT_TRUE(run.To(1));
    const Vec3 tip = run.DisplacementAt(Vec3(0.04, 0.0025, 0.001));
    std::printf("strip: tip moves by (%.3f, %.3f) mm; %lld iterations\n", 1e3 * tip.x(), 1e3 * tip.z(),
                static_cast<long long>(run.state.iterations));
    EXPECT_GT(tip.z(), 0.008);
    EXPECT_LT(run.solver.EquilibriumResidual(run.state), 1e-6);
    // The support balances the pressure on the bent face: it pulls back along x, too.
    EXPECT_GT(std::abs(run.Reaction(0).x()), 0.05 * std::abs(run.Reaction(0).z()));
  }
}

// A bar that hangs from its upper end, under gravity or under a body force of the same size.
Scene HangingBar(const Material& law, bool by_gravity, ElementOrder element) {
  Body body = BoxBody(Vec3(0.01, 0.01, 0.04), {2, 2, 6}, law, CellsOf(element));
  body.constraints = {Fix(kZ1, {false, false, true}), Fix(kX0, {true, false, false}), Fix(kY0, {false, true, false})};
  const TetMesh& mesh = body.tet().mesh;
  const PlaneSelector everywhere{Vec3(0, 0, -1), Vec3::UnitZ()};
  body.regions.push_back(mesh.hexahedra.empty() ? SelectRegion(mesh, BoundaryTriangles(mesh), "all", everywhere)
                                                : SelectRegion(mesh, BoundaryOfHexahedra(mesh), "all", everywhere));
  Load load;
  load.region = 6;
  load.kind = BodyForce{Vec3(0, 0, -9.81 * 1060)};
  if (!by_gravity) body.loads = {load};
  Scene scene = StaticScene(std::move(body), element);
  if (by_gravity) scene.gravity.acceleration = Vec3(0, 0, -9.81);
  return scene;
}
const Vec3 kLowerEnd(0.005, 0.005, 0);

// Linear elements and hexahedra: lumped masses are the integrals of the shape functions.
TEST(BodyForceTest, EqualsGravity) {
  const Material law = NeoHookean(std::array{1e4, 0.3});
  for (const ElementOrder element : {ElementOrder::kLinear, ElementOrder::kHexahedral}) {
    SteppedRun gravity(HangingBar(law, true, element));
    SteppedRun force(HangingBar(law, false, element));
    ASSERT_TRUE(gravity.To(1) && force.To(1));
    const double weight = 9.81 * 1060 * 4e-6, tip = gravity.DisplacementAt(kLowerEnd).z();
    EXPECT_NEAR(force.Reaction(0).z(), weight, 1e-7 * weight);
    EXPECT_NEAR(force.DisplacementAt(kLowerEnd).z(), tip, 1e-7 * std::abs(tip));
  }
}

// Quadratic elements: without lateral strain, u = rho g (L^2 - z^2) / 2E, which they can represent.
TEST(BodyForceTest, StretchesABarAsTheClosedFormSays) {
  SteppedRun run(HangingBar(LinearElastic(std::array{1e6, 0.0}), false, ElementOrder::kQuadratic));
  ASSERT_TRUE(run.To(1));
  for (std::size_t n = 0; n < run.model.nodes(); ++n) {
    const double z = 0.04 - run.model.rest_positions()[n].z();
    const double exact = -9.81 * 1060 * (0.04 * z - z * z / 2) / 1e6;
    ASSERT_NEAR(run.Displacement(n).z(), exact, 1e-13);
  }
}

// A block on springs without supports, pulled by a traction on the same face: it moves by F/k on every axis, as
// a whole.
TEST(SpringsTest, HoldABlock) {
  for (const ElementOrder element : kEveryElement) {
    Body body = BoxBody(Vec3(0.01, 0.01, 0.02), {2, 2, 4}, NeoHookean(std::array{1e6, 0.3}), CellsOf(element));
    Load springs;
    springs.region = kZ0;
    springs.kind = Springs{Vec3(50, 60, 200)};
    Load pull;
    pull.region = kZ0;
    pull.kind = Traction{Vec3(0.01, -0.02, 0.04) / 1e-4};
    pull.scale = Ramp(1);
    body.loads = {springs, pull};
    Scene scene = StaticScene(std::move(body), element);
    Problems problems;
    CheckScene(scene, problems);
    EXPECT_TRUE(problems.empty()) << problems.ToString();
    SteppedRun run(std::move(scene));
    ASSERT_TRUE(run.To(1));
    for (std::size_t n = 0; n < run.model.nodes(); ++n) {
      EXPECT_LT((run.Displacement(n) - Vec3(0.01 / 50, -0.02 / 60, 0.04 / 200)).norm(), 1e-9);
    }
  }
}

// On a region without faces, here the nodes of an edge, they are in equal parts on the nodes.
TEST(SpringsTest, HoldNodes) {
  Body body = BoxBody(Vec3(0.01, 0.01, 0.02), {2, 2, 4}, NeoHookean(std::array{1e6, 0.3}));
  body.constraints = {Fix(kZ0)};
  body.regions.push_back(SelectRegion(body.tet().mesh, BoundaryTriangles(body.tet().mesh), "edge",
                                      BoxSelector{Vec3(0.0099, -1, 0.0199), Vec3(1, 1, 1)}));
  Load springs;
  springs.region = 6;
  springs.kind = Springs{Vec3(300, 0, 0)};
  body.loads = {springs};
  const Scene scene = StaticScene(std::move(body), ElementOrder::kQuadratic);
  const TetModel model(scene);
  ASSERT_EQ(model.position_loads().springs[0].entries.size(), 5u);
  for (const SpringEntry& entry : model.position_loads().springs[0].entries) {
    EXPECT_EQ(entry.row, entry.column);
    EXPECT_EQ(entry.stiffness, Vec3(60, 0, 0));
  }
}

// Two bars, each fixed at its far end, with a line spring between the ends that face each other, 10 mm apart: three
// springs in series. The bars' stiffness is E A / l as their sides are free and Poisson's ratio is 0.
Scene TwoBars(ElementOrder element, Stepping stepping, double rest_length, bool tension_only) {
  const auto bar = [](const char* name, double x) {
    TetMesh mesh = MakeBox(Vec3(x, 0, 0), Vec3(0.02, 0.01, 0.01), {3, 2, 2});
    Body body = MakeBody(name, std::move(mesh), LinearElastic(std::array{1e4, 0.0}));
    body.damping.mass_proportional = 20;
    return body;
  };
  Body left = bar("left", 0), right = bar("right", 0.03);
  left.constraints = {Fix(kX0, {true, false, false}), Fix(kY0, {false, true, false}), Fix(kZ0, {false, false, true})};
  right.constraints = {Fix(kX1, {true, false, false}), Fix(kY0, {false, true, false}), Fix(kZ0, {false, false, true})};
  Load spring;
  spring.region = kX1;
  LineSpring line;
  line.body = 1;
  line.region = kX0;
  line.stiffness = 30;
  line.rest_length = rest_length;
  line.tension_only = tension_only;
  spring.kind = line;
  left.loads = {spring};
  Scene scene = StaticScene(std::move(left), element);
  right.tet().fibres = scene.bodies[0].tet().fibres;
  scene.bodies.push_back(std::move(right));
  scene.tet.stepping = stepping;
  scene.duration = 2;
  return scene;
}

TEST(LineSpringTest, PullsTwoBodiesTogether) {
  const double bar = 1e4 * 1e-4 / 0.02, series = 1 / (2 / bar + 1 / 30.0);
  for (const double rest_length : {0.006, 0.012}) {
    const double force = series * (0.01 - rest_length);
    for (const ElementOrder element : {ElementOrder::kLinear, ElementOrder::kQuadratic}) {
      SteppedRun run(TwoBars(element, Stepping::kQuasiStatic, rest_length, false));
      ASSERT_TRUE(run.To(2));
      EXPECT_NEAR(run.Reaction(0).x(), -force, 1e-8);
      EXPECT_NEAR(run.DisplacementAt(Vec3(0.02, 0, 0)).x(), force / bar, 1e-9);
      EXPECT_NEAR(run.DisplacementAt(Vec3(0.03, 0.01, 0)).x(), -force / bar, 1e-9);
      EXPECT_LT(run.solver.EquilibriumResidual(run.state), 1e-6);
    }
  }
  SteppedRun moving(TwoBars(ElementOrder::kLinear, Stepping::kExplicit, 0.006, false));
  ASSERT_TRUE(moving.To(2));
  EXPECT_NEAR(moving.DisplacementAt(Vec3(0.02, 0, 0)).x(), series * 0.004 / bar, 1e-6);
}

TEST(LineSpringTest, IsSlackIfOnlyTensionIsAskedFor) {
  SteppedRun run(TwoBars(ElementOrder::kQuadratic, Stepping::kQuasiStatic, 0.012, true));
  ASSERT_TRUE(run.To(2));
  EXPECT_NEAR(run.Reaction(0).x(), 0, 1e-12);
}

// A bar on a pin at one end, pulled up by a line spring fixed at a small block above: the spring's direction turns with
// the bar, and the moments about the pin balance.
TEST(LineSpringTest, TurnsWithItsEnds) {
  Body bar = BoxBody(Vec3(0.04, 0.005, 0.005), {8, 1, 1}, NeoHookean(std::array{1e7, 0.3}));
  bar.regions.push_back(SelectRegion(bar.tet().mesh, BoundaryTriangles(bar.tet().mesh), "pin",
                                     BoxSelector{Vec3(-1, -1, -1), Vec3(1e-6, 1, 1e-6)}));
  bar.constraints = {{6, {true, true, true}, {}}};
  Load spring, weight;
  spring.region = kX1;
  LineSpring line;
  line.body = 1;
  line.region = kZ0;
  line.stiffness = 2;
  line.rest_length = 0.005;
  spring.kind = line;
  weight.region = kX1;
  weight.kind = Traction{Vec3(0, 0, -0.03) / 2.5e-5};
  weight.scale = Ramp(1);
  bar.loads = {spring, weight};
  Body anchor = MakeBody("anchor", MakeBox(Vec3(0.02, 0, 0.03), Vec3(0.005, 0.005, 0.005), {1, 1, 1}),
                         NeoHookean(std::array{1e7, 0.3}));
  anchor.constraints = {Fix(kZ1)};
  Scene scene = StaticScene(std::move(bar), ElementOrder::kQuadratic);
  anchor.tet().fibres = ConstantFibres(anchor.tet().mesh, Vec3::UnitX());
  scene.bodies.push_back(std::move(anchor));
  SteppedRun run(std::move(scene));
  ASSERT_TRUE(run.To(1));
  const LineSpringLoad& load = run.model.position_loads().line_springs[0];
  const auto middle = [&](int end) {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < load.ends[end].nodes.size(); ++i) {
      sum += load.ends[end].weights[i] * run.state.positions[static_cast<std::size_t>(load.ends[end].nodes[i])];
    }
    return sum;
  };
  const Vec3 rise = middle(0) - Vec3(0.04, 0.0025, 0.0025);
  std::printf("bar on a pin: its end moves by (%.3f, %.3f) mm; %lld iterations\n", 1e3 * rise.x(), 1e3 * rise.z(),
              static_cast<long long>(run.state.iterations));
  EXPECT_GT(rise.norm(), 0.002);
  const Vec3 along = middle(1) - middle(0);
  const Vec3 pull = 2 * (along.norm() - 0.005) * along.normalized();
  const Vec3 moment = middle(0).cross(pull + Vec3(0, 0, -0.03));
  EXPECT_LT(std::abs(moment.y()), 1e-6 * middle(0).norm() * pull.norm()) << "about the pin";
  EXPECT_LT((run.Reaction(0) + pull + Vec3(0, 0, -0.03)).norm(), 1e-7);
}

// Explicit steps, damped, end in the equilibrium that quasi-static steps find.
TEST(PositionLoadsTest, ExplicitStepsEndInTheSameEquilibrium) {
  Body body = BoxBody(Vec3(0.02, 0.01, 0.005), {4, 2, 1}, NeoHookean(std::array{2e4, 0.3}));
  Load springs;
  springs.region = kX0;
  springs.kind = Springs{Vec3(100, 100, 100)};
  body.loads = {springs, PressureOn(kZ1, 50)};
  Scene scene = StaticScene(std::move(body), ElementOrder::kLinear);
  SteppedRun still(scene);
  ASSERT_TRUE(still.To(1));
  scene.tet.stepping = Stepping::kExplicit;
  scene.bodies[0].damping.mass_proportional = 20;
  scene.duration = 3;
  SteppedRun moving(scene);
  ASSERT_TRUE(moving.To(3));
  const Vec3 end(0.02, 0.005, 0.0025);
  const double deflection = still.DisplacementAt(end).norm();
  EXPECT_GT(deflection, 5e-4);
  EXPECT_LT((moving.DisplacementAt(end) - still.DisplacementAt(end)).norm(), 0.002 * deflection);
}

}  // namespace
}  // namespace fascicle
