#ifndef FASCICLE_TESTS_SUPPORT_ISOMETRIC_MUSCLE_H_
#define FASCICLE_TESTS_SUPPORT_ISOMETRIC_MUSCLE_H_

#include <array>
#include <cmath>

#include "tests/support/reference_problems.h"
#include "tests/support/static_run.h"

// Reference problem d, a muscle with fixed ends, in the sizes of the benchmarks: quadratic elements with curved edges
// on n x n x lengthwise hexahedra of six tetrahedra each.
namespace fascicle::testing {

struct MuscleGrid {
  int n;
  int lengthwise;

  int FreeComponents() const { return 3 * (2 * n + 1) * (2 * n + 1) * (2 * lengthwise - 1); }
  int Tetrahedra() const { return 6 * n * n * lengthwise; }
};

inline constexpr std::array<MuscleGrid, 9> kMuscleGrids = {
    {{2, 8}, {3, 12}, {4, 20}, {6, 20}, {8, 28}, {10, 38}, {12, 54}, {16, 64}, {20, 80}}};

// The one whose number of free components is closest to a given one, by ratio.
inline MuscleGrid NearestMuscleGrid(double components) {
  MuscleGrid best = kMuscleGrids[0];
  const auto distance = [&](const MuscleGrid& grid) { return std::abs(std::log(grid.FreeComponents() / components)); };
  for (const MuscleGrid& grid : kMuscleGrids) {
    if (distance(grid) < distance(best)) best = grid;
  }
  return best;
}

// Activation t at time t in [0, 1] s, quasi-static.
inline Scene IsometricMuscle(const MuscleGrid& grid) {
  return StaticScene(ReferenceMuscle(grid.n, grid.lengthwise, Ramp(1)), ElementOrder::kQuadratic);
}

// The other problems of quasistatic_bench. Their loads rise with time, in [0, 1] s, too.
//
// Problem d bent to an arc of 120 degrees before it contracts.
inline Body BentMuscleBody(const MuscleGrid& grid, Cells cells = Cells::kTetrahedra) {
  Body body = ReferenceMuscle(grid.n, grid.lengthwise, Ramp(1), cells);
  const double length = 0.1, angle = 2 * std::numbers::pi / 3, radius = length / angle;
  const auto bent = [&](const Vec3& X) {
    const double turn = X[2] / radius, arm = radius + X[0];
    return Vec3(arm * std::cos(turn) - radius, X[1], arm * std::sin(turn));
  };
  TetMesh& mesh = body.tet().mesh;
  for (std::size_t e = 0; e < ElementCount(mesh); ++e) {
    const double turn = ElementCentroid(mesh, e)[2] / radius;
    const Vec3 fibre = body.tet().fibres[e];
    body.tet().fibres[e] = Vec3(std::cos(turn) * fibre[0] - std::sin(turn) * fibre[2], fibre[1],
                                std::sin(turn) * fibre[0] + std::cos(turn) * fibre[2]);
  }
  for (Vec3& X : mesh.nodes) X = bent(X);
  for (CurvedEdge& edge : mesh.curved_edges) edge.middle = bent(edge.middle);
  return body;
}
inline Scene BentMuscle(const MuscleGrid& grid) { return StaticScene(BentMuscleBody(grid), ElementOrder::kQuadratic); }

// A quarter of a ring of muscle, fibres around it, with planes of symmetry at its ends (x = 0 and y = 0) and below; it
// narrows.
inline Body MuscleRingBody(const MuscleGrid& grid, Cells cells = Cells::kTetrahedra) {
  const double inner = 0.01, outer = 0.02, quarter = std::numbers::pi / 2;  // [m]
  const auto place = [&](const Vec3& p) {
    const double radius = inner + (outer - inner) * p[0];
    return Vec3(radius * std::cos(quarter * p[2]), radius * std::sin(quarter * p[2]), (outer - inner) * p[1]);
  };
  TetMesh mesh = MakeBox(Vec3::Zero(), Vec3::Ones(), {grid.n, grid.n, grid.lengthwise}, cells);
  FibreField fibres;
  for (std::size_t e = 0; e < ElementCount(mesh); ++e) {
    const double turn = quarter * ElementCentroid(mesh, e)[2];
    fibres.emplace_back(-std::sin(turn), std::cos(turn), 0);
  }
  Place(place, mesh);
  Body body = MakeBody("ring", std::move(mesh), Muscle(std::array{0.03e6, 0.01e6, 8e6, 0.3e6, 1.0, 0.05, 6.6, 1.4}));
  body.tet().fibres = std::move(fibres);
  body.constraints = {Fix(kX0, {true, false, false}), Fix(kY0, {false, true, false}), Fix(kZ0, {false, false, true})};
  body.activation = Ramp(1);
  return body;
}
inline Scene MuscleRing(const MuscleGrid& grid) { return StaticScene(MuscleRingBody(grid), ElementOrder::kQuadratic); }

// A block of rubber, K/mu = 1000, stretched by half between rough plates.
inline Scene StretchedBlock(const MuscleGrid& grid) {
  const int n = static_cast<int>(std::cbrt(grid.FreeComponents() / 24.0) + 0.5);
  return StaticScene(ClampedCube(n, NearlyIncompressible(), Ramp(0.005)), ElementOrder::kQuadratic);
}

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_SUPPORT_ISOMETRIC_MUSCLE_H_
