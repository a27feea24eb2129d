// Problem a of the FEBio reference results: a neo-Hookean cantilever under a dead end load.
#include <gtest/gtest.h>

#include "core/sim/control_source.h"
#include "core/tet/diagnostics.h"
#include "tests/support/reference_file.h"
#include "tests/support/tet_scenes.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;

// 20 x 2 x 2 hexahedra of six tetrahedra; E = 1000 MPa, nu = 0.3, 1 N downwards on the free end. Brought to rest by
// mass damping of the lowest bending mode, omega = 3.516 sqrt(E/rho) h / (sqrt(12) L^2) = 1e4 1/s, by 0.4 of the
// critical damping. The density does not matter at rest.
TEST(FebioTest, CantileverNodeByNode) {
  const auto results = ReadReference("a_cantilever_neohookean");
  if (!results) GTEST_SKIP() << NoReference();
  const nlohmann::json& field = results->at("full_fields_coarsest_mesh").at("tet4");
  ASSERT_EQ(field.at("run"), "a_tet4_20");

  Body body = BoxBody(Vec3(0.01, 0.001, 0.001), {20, 2, 2}, NeoHookean(std::array{1e9, 0.3}));
  const auto& coordinates = field.at("node_coordinates");
  ASSERT_EQ(coordinates.size(), body.tet().mesh.nodes.size());
  for (std::size_t n = 0; n < coordinates.size(); ++n) {
    for (int c = 0; c < 3; ++c) ASSERT_NEAR(coordinates[n][c].get<double>() * 1e-3, body.tet().mesh.nodes[n][c], 1e-12);
  }
  const auto& elements = field.at("elements_0based");
  ASSERT_EQ(elements.size(), body.tet().mesh.tetrahedra.size());
  for (std::size_t e = 0; e < elements.size(); ++e) {
    ASSERT_EQ(elements[e].get<Tetrahedron>(), body.tet().mesh.tetrahedra[e]);
  }
  body.constraints = {Fix(kX0)};
  body.loads.push_back(
      {kX1, Traction{Vec3(0, 0, -1 / 1e-6)}, Curve{{0, 2e-3}, {0, 1}, Curve::Interpolation::kSmooth}, {}});
  body.density = 1000;
  body.damping.mass_proportional = 8000;
  Scene scene = OneBody(body);
  scene.output.frame_interval = 5e-4;
  scene.output.settle_speed = 1e-6;
  scene.duration = 0.1;

  // Consistent nodal forces, as in the reference.
  const TetModel model(scene);
  ThreadTeam team(1);
  ControlSource source(scene);
  NodalVector external;
  ExternalForce(model, source.At(1), team, external);
  for (const auto& row : field.at("nodal_forces_final")) {
    const Vec3 force(row[1], row[2], row[3]);
    EXPECT_LT((external[row[0].get<std::size_t>()] - force).norm(), 1e-12);
  }

  const RunResult run = RunScene(scene);
  ASSERT_EQ(run.outcome.kind, Outcome::Kind::kSucceeded) << run.outcome.failure.message;
  const auto& displacements = field.at("displacement_final");
  double tip = 0, largest = 0;
  for (std::size_t n = 0; n < displacements.size(); ++n) {
    const Vec3 reference = 1e-3 * Vec3(displacements[n][0], displacements[n][1], displacements[n][2]);
    const Vec3 ours = run.frames.back().bodies[0].positions[n] - body.tet().mesh.nodes[n];
    tip = std::max(tip, std::abs(reference[2]));
    largest = std::max(largest, (ours - reference).norm());
  }
  TetState state;
  state.time = run.frames.back().time;
  state.positions = run.frames.back().bodies[0].positions;
  state.velocities.assign(model.nodes(), Vec3::Zero());
  const double residual = EquilibriumResidual(model, state, source.At(state.time), team);
  std::printf("FEBio a_tet4_20: tip %.6g mm, largest difference of a node %.3g %% of it, residual %.2g, %lld steps\n",
              1e3 * tip, 100 * largest / tip, residual, static_cast<long long>(run.frames.back().step));
  EXPECT_LT(largest, 0.005 * tip);
  EXPECT_LT(residual, 1e-3);
  EXPECT_NEAR(run.Last("box/reaction/x0/z"), 1, 1e-3);
}

}  // namespace
}  // namespace fascicle
