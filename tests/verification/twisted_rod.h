#ifndef FASCICLE_TESTS_VERIFICATION_TWISTED_ROD_H_
#define FASCICLE_TESTS_VERIFICATION_TWISTED_ROD_H_

#include <cstdio>
#include <numbers>
#include <set>

#include "tests/support/static_run.h"

// A round rod along z with a curved surface, one end of which is rotated at constant length.
namespace fascicle::testing {

constexpr double kRodRadius = 0.005, kRodLength = 0.02, kRodAngle = std::numbers::pi / 2;  // [m], [m], [rad]

inline TetMesh RodMesh() {
  TetMesh mesh = MakeFusiform({.length = kRodLength,
                               .belly_radius = kRodRadius,
                               .end_radius = kRodRadius,
                               .divisions_across = 4,
                               .divisions_along = 8});
  std::set<std::array<std::int32_t, 2>> edges;
  for (const Triangle& t : BoundaryTriangles(mesh)) {
    for (int c = 0; c < 3; ++c) {
      const auto [i, j] = std::minmax(t[c], t[(c + 1) % 3]);
      const auto is_outside = [&](std::int32_t n) { return mesh.nodes[n].head<2>().norm() > (1 - 1e-9) * kRodRadius; };
      if (!is_outside(i) || !is_outside(j) || !edges.insert({i, j}).second) continue;
      Vec3 middle = 0.5 * (mesh.nodes[i] + mesh.nodes[j]);
      middle.head<2>() *= kRodRadius / middle.head<2>().norm();
      mesh.curved_edges.push_back({{i, j}, middle});
    }
  }
  return mesh;
}

// Torque about the axis [N m] and force along it [N] at the rotated end.
struct RodForces {
  double torque = 0, axial = 0;
};

// Rotates the end of a body with RodMesh in four steps, then sets its activation. Prints both forces beside the exact
// ones.
inline RodForces TwistRod(Body body, double activation, const RodForces& exact) {
  Constraint turn = Fix(kZ1);
  turn.motion.rotation = Rotation{Vec3::Zero(), Vec3::UnitZ(), Ramp(kRodAngle)};
  body.constraints = {Fix(kZ0), turn};
  body.activation = Ramp(activation);
  Scene scene = StaticScene(std::move(body), ElementOrder::kQuadratic);
  scene.tet.time_step = 0.25;
  SteppedRun run(scene);
  EXPECT_TRUE(run.To(1));
  NodalVector force;
  ForceWorkspace workspace;
  ElasticForce(run.model, std::array{activation}, run.state.positions, run.team, workspace, force);
  RodForces result;
  for (const std::int32_t n : run.model.supports()[1].nodes) {
    result.torque -= run.state.positions[n].cross(force[n])[2];
    result.axial -= force[n][2];
  }
  std::printf("torque %.5g N m, exact %.5g; axial force %.5g N, exact %.5g; %lld iterations\n", result.torque,
              exact.torque, result.axial, exact.axial, static_cast<long long>(run.state.iterations));
  return result;
}

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_VERIFICATION_TWISTED_ROD_H_
