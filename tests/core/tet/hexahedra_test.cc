// Hexahedral elements: rest data, loads, rigid motions, momentum and steps of every kind.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "core/scene/probe_place.h"
#include "core/sim/control_source.h"
#include "core/tet/diagnostics.h"
#include "core/tet/fields.h"
#include "core/tet/points.h"
#include "tests/support/reference_problems.h"
#include "tests/support/static_run.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;
using ::testing::HasSubstr;

constexpr ElementOrder kHexahedral = ElementOrder::kHexahedral;
const Vec3 kBarSize(0.03, 0.02, 0.01);

// A bar all of whose nodes are moved by a fraction of the distance between them, so that no side is flat.
Body CrookedBar(const Material& law, const std::array<int, 3>& divisions = {4, 3, 2}) {
  TetMesh mesh = MakeBox(Vec3::Zero(), kBarSize, divisions, Cells::kHexahedra);
  const std::vector<Vec3> straight = mesh.nodes;
  Body body = MakeBody("bar", std::move(mesh), law);
  body.tet().mesh.nodes = Shaken(straight, 4e-4, 3);
  return body;
}

Scene CrookedScene(const Material& law, ElementOrder element = kHexahedral) {
  Scene scene = OneBody(CrookedBar(law));
  scene.tet.element = element;
  return scene;
}

class EveryHexahedronTest : public ::testing::TestWithParam<ElementOrder> {};
INSTANTIATE_TEST_SUITE_P(Elements, EveryHexahedronTest,
                         ::testing::Values(kHexahedral, ElementOrder::kHexahedralQuadratic),
                         [](const auto& element) { return ElementNameOf(element.param); });

MooneyRivlin Rubber() { return MooneyRivlin(std::array{2e3, 1e3, 2e6}); }

// The volume of a trilinear hexahedron by a finer rule: 4 x 4 x 4 midpoints of a polynomial of degree two in each
// coordinate, extrapolated.
double VolumeByMidpoints(const HexahedronNodes& nodes) {
  const auto by = [&](int n) {
    double sum = 0;
    for (int i = 0; i < n * n * n; ++i) {
      const Vec3 x(i % n + 0.5, i / n % n + 0.5, i / (n * n) + 0.5);
      sum += TrilinearSlopes(nodes, x / n).determinant() / (n * n * n);
    }
    return sum;
  };
  return (4 * by(8) - by(4)) / 3;
}

TEST(HexahedraTest, VolumeAndMassAreThoseOfTheTrilinearMap) {
  const Scene scene = CrookedScene(Rubber());
  const TetModel model(scene);
  const TetMesh& mesh = scene.bodies[0].tet().mesh;
  ASSERT_EQ(model.elements(), 24u);
  ASSERT_EQ(model.patches().size(), 24u);
  double whole = 0;
  for (std::size_t e = 0; e < model.elements(); ++e) {
    double volume = 0;
    for (int q = 0; q < 8; ++q) volume += model.rest_volume()[8 * e + q];
    const auto h = static_cast<std::size_t>(model.source_element()[e]);
    EXPECT_NEAR(volume, VolumeByMidpoints(NodesOfHexahedron(mesh, h)), 1e-6 * volume);
    EXPECT_NEAR(volume, model.patches().rest_volume[model.patches().of_element[e][0]], 1e-14 * volume);
    whole += volume;
  }
  double mass = 0;
  Vec3 first_moment = Vec3::Zero();
  for (std::size_t n = 0; n < model.nodes(); ++n) {
    EXPECT_GT(model.mass()[n], 0);
    mass += model.mass()[n];
    first_moment += model.mass()[n] * mesh.nodes[n];
  }
  EXPECT_NEAR(mass, 1060 * whole, 1e-13 * mass);
  // Row sums keep the centre of mass: that of the trilinear map, here by the points.
  Vec3 by_points = Vec3::Zero();
  for (std::size_t e = 0; e < model.elements(); ++e) {
    const HexahedronNodes nodes = NodesOfHexahedron(mesh, static_cast<std::size_t>(model.source_element()[e]));
    for (int q = 0; q < 8; ++q) {
      const Vec3 place(HexahedralShape::Place(q, 0), HexahedralShape::Place(q, 1), HexahedralShape::Place(q, 2));
      by_points += 1060 * model.rest_volume()[8 * e + q] * TrilinearValue(nodes, place);
    }
  }
  EXPECT_LT((first_moment - by_points).norm(), 1e-13 * by_points.norm());
}

// A traction on crooked sides: the resultant is the area times the traction, and its moment that of the surface.
TEST(HexahedraTest, TractionsAreConsistent) {
  Body body = CrookedBar(Rubber());
  body.constraints = {Fix(kX0)};
  body.loads.push_back({kX1, Traction{Vec3(300, -200, 500)}, Curve::Constant(1), {}});
  Scene scene = OneBody(std::move(body));
  scene.tet.element = kHexahedral;
  const TetModel model(scene);
  const TetMesh& mesh = scene.bodies[0].tet().mesh;
  ASSERT_EQ(scene.bodies[0].regions[kX1].sides.size(), 6u);
  Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
  const NodalLoad& load = model.loads().at(0);
  ASSERT_EQ(load.nodes.size(), 12u);
  for (std::size_t i = 0; i < load.nodes.size(); ++i) {
    force += load.forces[i];
    moment += mesh.nodes[static_cast<std::size_t>(load.nodes[i])].cross(load.forces[i]);
  }
  // By 20 x 20 midpoints on each side.
  double area = 0;
  Vec3 centre = Vec3::Zero();
  constexpr int kFine = 20;
  for (const Quad& side : scene.bodies[0].regions[kX1].sides) {
    std::array<Vec3, 4> X;
    for (std::size_t c = 0; c < 4; ++c) X[c] = mesh.nodes[static_cast<std::size_t>(side[c])];
    for (int i = 0; i < kFine * kFine; ++i) {
      const double u = (i % kFine + 0.5) / kFine, v = (i / kFine + 0.5) / kFine;
      const Vec3 along_u = (1 - v) * (X[1] - X[0]) + v * (X[2] - X[3]);
      const Vec3 along_v = (1 - u) * (X[3] - X[0]) + u * (X[2] - X[1]);
      const double part = along_u.cross(along_v).norm() / (kFine * kFine);
      area += part;
      centre += part * ((1 - u) * (1 - v) * X[0] + u * (1 - v) * X[1] + u * v * X[2] + (1 - u) * v * X[3]);
    }
  }
  const Vec3 traction(300, -200, 500);
  EXPECT_LT((force - area * traction).norm(), 1e-3 * force.norm());
  EXPECT_LT((moment - centre.cross(traction)).norm(), 1e-3 * moment.norm());
}

// No forces, no energy, J = 1, for every law; also in float.
TEST_P(EveryHexahedronTest, RigidMotionsAreFreeOfForce) {
  const Mat3 R = Eigen::AngleAxisd(0.8, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
  for (const Material& law : EveryLaw()) {
    if (std::holds_alternative<LinearElastic>(law)) continue;  // not objective
    Scene scene = CrookedScene(law, GetParam());
    const TetModel model(scene);
    ThreadTeam team(1);
    ForceWorkspace workspace;
    const std::array<double, 1> activation = {0};
    NodalVector x, rest_force, force, strained, strained_force;
    for (const Vec3& X : model.rest_positions()) x.push_back(R * X + Vec3(0.1, 0.2, -0.1));
    ElasticForce(model, activation, model.rest_positions(), team, workspace, rest_force);
    const ForceReport report = ElasticForce(model, activation, x, team, workspace, force);
    EXPECT_TRUE(report.valid);
    for (const double theta : workspace.ratio) EXPECT_NEAR(theta, 1, 1e-13);
    strained = Shaken(model.rest_positions(), 3e-4, 5);
    ElasticForce(model, activation, strained, team, workspace, strained_force);
    // Fibres may pull at rest: then the forces turn with the body.
    for (std::size_t n = 0; n < x.size(); ++n) {
      EXPECT_LT((force[n] - R * rest_force[n]).norm(), 1e-9 * LargestNorm(strained_force));
    }
    Vec3 sum = Vec3::Zero(), moment = Vec3::Zero();
    for (std::size_t n = 0; n < x.size(); ++n) {
      sum += strained_force[n];
      moment += strained[n].cross(strained_force[n]);
    }
    EXPECT_LT(sum.norm(), 1e-12 * LargestNorm(strained_force));
    EXPECT_LT(moment.norm(), 1e-13 * LargestNorm(strained_force));
  }
}

// A bar that flies and deforms keeps its momentum and angular momentum, and its energy to the order of the steps.
TEST_P(EveryHexahedronTest, AFreeBarKeepsItsMomenta) {
  Scene scene = CrookedScene(NeoHookean(std::array{1e5, 0.45}), GetParam());
  const TetModel model(scene);
  ThreadTeam team(2);
  TetStepper solver(model, team);
  TetState state = solver.InitialState();
  const Vec3 spin(20, 5, -30);
  for (std::size_t n = 0; n < model.nodes(); ++n) {
    const Vec3& X = model.rest_positions()[n];
    state.velocities[n] = Vec3(1, 0.5, 0) + spin.cross(X) + Vec3(60 * X[0], -40 * X[1], 0);
  }
  const auto momenta = [&] {
    Eigen::Matrix<double, 6, 1> sums = Eigen::Matrix<double, 6, 1>::Zero();
    for (std::size_t n = 0; n < model.nodes(); ++n) {
      const Vec3 p = model.mass()[n] * state.velocities[n];
      sums.head<3>() += p;
      sums.tail<3>() += state.positions[n].cross(p);
    }
    return sums;
  };
  const auto energy = [&] {
    return KineticEnergy(model, state.velocities, team) +
           ElasticEnergy(model, 0, std::array{0.0}, state.positions, team);
  };
  const auto before = momenta();
  const double energy_before = energy();
  while (state.time < 0.01) ASSERT_EQ(solver.Advance(state, 0.01).problem, StepProblem::kNone);
  EXPECT_LT((momenta() - before).head<3>().norm(), 1e-11 * before.head<3>().norm());
  EXPECT_LT((momenta() - before).tail<3>().norm(), 1e-11 * before.tail<3>().norm());
  EXPECT_NEAR(energy(), energy_before, 0.01 * energy_before);
}

// Every stepping arrives at the same equilibrium.
TEST_P(EveryHexahedronTest, EverySteppingFindsTheSameEquilibrium) {
  const auto scene_of = [element = GetParam()](Stepping stepping) {
    // With the same nodes, explicit steps of quadratic elements would be shorter.
    const std::array<int, 3> divisions = element == kHexahedral ? std::array{3, 2, 2} : std::array{2, 1, 1};
    Body body = BoxBody(kBarSize, divisions, Rubber(), Cells::kHexahedra);
    body.constraints = {Fix(kX0)};
    body.loads.push_back(
        {kX1, Traction{Vec3(300, 0, -60)}, Curve{{0, 0.2}, {0, 1}, Curve::Interpolation::kSmooth}, {}});
    body.damping = {.mass_proportional = 40, .viscosity = 20};
    Scene scene = OneBody(std::move(body));
    scene.tet.stepping = stepping;
    scene.tet.element = element;
    scene.duration = 0.6;
    if (stepping != Stepping::kExplicit && stepping != Stepping::kMixed) scene.tet.time_step = 0.005;
    return scene;
  };
  SteppedRun rest(scene_of(Stepping::kQuasiStatic));
  ASSERT_TRUE(rest.To(0.6));
  ASSERT_GT(rest.DisplacementAt(kBarSize).norm(), 1e-3);
  for (const Stepping stepping :
       {Stepping::kExplicit, Stepping::kMixed, Stepping::kBackwardEuler, Stepping::kNewmark, Stepping::kBdf2}) {
    SteppedRun run(scene_of(stepping));
    ASSERT_TRUE(run.To(0.6)) << static_cast<int>(stepping);
    EXPECT_LT((run.DisplacementAt(kBarSize) - rest.DisplacementAt(kBarSize)).norm(),
              2e-3 * rest.DisplacementAt(kBarSize).norm())
        << static_cast<int>(stepping);
  }
}

// A trilinear displacement is interpolated exactly, in crooked hexahedra, at nodes and within.
TEST_P(EveryHexahedronTest, ProbesAreInterpolated) {
  SteppedRun run(CrookedScene(NeoHookean(std::array{1e4, 0.3}), GetParam()));
  const TetMesh& mesh = run.scene.bodies[0].tet().mesh;
  Mat3 F;
  F << 1.1, 0.2, 0, -0.1, 0.9, 0.1, 0, 0.05, 1.05;
  for (std::size_t n = 0; n < run.model.nodes(); ++n) run.state.positions[n] = F * run.model.rest_positions()[n];
  Controls controls;
  controls.activations = {0};
  for (const Vec3& X : {Vec3(0.0123, 0.0041, 0.0077), Vec3(0.0251, 0.0101, 0.0022), mesh.nodes[17]}) {
    const LocatedProbe located = LocateProbe("p", 0, run.scene.bodies[0].shape, X);
    EXPECT_LT(located.outside, 1e-12);
    EXPECT_LT((DisplacementAt(run.model, located.probe, run.state) - (F * X - X)).norm(), 1e-15);
    const auto J = FieldValuesAt(run.model, located.probe, OutputField::kVolumeRatio, run.state, controls, run.team);
    EXPECT_NEAR(J[0], F.determinant(), 1e-12);
  }
}

// Elements and meshes that do not match are refused.
TEST(HexahedraTest, NeedHexahedra) {
  const auto problem_of = [](Cells cells, ElementOrder element) {
    Body body = BoxBody(kBarSize, {2, 2, 2}, Rubber(), cells);
    body.constraints = {Fix(kX0)};
    Scene scene = OneBody(std::move(body));
    scene.tet.element = element;
    Problems problems;
    CheckScene(scene, problems);
    return problems.ToString();
  };
  EXPECT_EQ(problem_of(Cells::kHexahedra, kHexahedral), "");
  EXPECT_THAT(problem_of(Cells::kTetrahedra, kHexahedral), HasSubstr("bodies[0].mesh: has tetrahedra"));
  EXPECT_THAT(problem_of(Cells::kHexahedra, ElementOrder::kLinear), HasSubstr("bodies[0].mesh: has hexahedra"));
}

}  // namespace
}  // namespace fascicle
