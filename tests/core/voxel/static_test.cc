#include "core/voxel/static_solver.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>

#include "core/voxel/coarse_and_fine.h"
#include "core/voxel/fields.h"
#include "tests/support/voxel_scenes.h"

namespace fascicle {
namespace {

using testing::BoxGrid;
using testing::SpongeGrid;

using Displacement = std::function<Vec3(const Vec3&)>;

Vec3 PlaceOf(const VoxelMesh& mesh, const GridIndex& at) {
  return mesh.spacing().cwiseProduct(Vec3(at[0], at[1], at[2]));
}

// Prescribes displacements of nodes, each by a support of its own.
template <class Which>
std::vector<VoxelSupport> Prescribe(const VoxelMesh& mesh, const Which& which, const Displacement& u) {
  std::vector<VoxelSupport> supports;
  for (const GridIndex& at : mesh.NodePlaces()) {
    if (which(at)) supports.push_back({{at}, {true, true, true}, u(PlaceOf(mesh, at))});
  }
  return supports;
}

double LargestError(const VoxelMesh& mesh, const VoxelField<double>& u, const Displacement& exact) {
  double error = 0, largest = 0;
  std::int32_t node = 0;
  for (const GridIndex& at : mesh.NodePlaces()) {
    const Vec3 expected = exact(PlaceOf(mesh, at));
    error = std::max(error, (u.At(node++) - expected).norm());
    largest = std::max(largest, expected.norm());
  }
  return error / largest;
}

double LargestErrorAtCentres(const VoxelMesh& mesh, const VoxelField<double>& u, const Displacement& exact) {
  double error = 0, largest = 0;
  ForVoxels(mesh, [&](std::int32_t, const GridIndex& at, const std::array<std::int32_t, 8>& nodes) {
    Vec3 mean = Vec3::Zero();
    for (const std::int32_t node : nodes) mean += u.At(node) / 8;
    const Vec3 expected = exact(PlaceOf(mesh, at) + 0.5 * mesh.spacing());
    error = std::max(error, (mean - expected).norm());
    largest = std::max(largest, expected.norm());
  });
  return error / largest;
}

auto OnSurface(const GridIndex& size) {
  return [size](const GridIndex& at) {
    for (int d = 0; d < 3; ++d) {
      if (at[d] == 0 || at[d] == size[d]) return true;
    }
    return false;
  };
}

// Linear displacements are exact for any supported surface and any spacing.
TEST(Patch, LinearDisplacementsAreExact) {
  const GridIndex size = {7, 9, 11};
  Mat3 A;
  A << 1e-3, 2e-3, -1e-3, 0.5e-3, -3e-3, 1e-3, 2e-3, 0, 1.5e-3;
  const Displacement linear = [&A](const Vec3& X) { return Vec3(A * X + Vec3(1e-4, 2e-4, -1e-4)); };
  ThreadTeam team(1);
  for (const Dilatation dilatation : {Dilatation::kFull, Dilatation::kMean}) {
    const VoxelGrid grid = BoxGrid(size, {1e-3, 0.7e-3, 1.9e-3});
    const VoxelModel model(grid, {{3e4, 0.4}}, dilatation);
    VoxelStaticSolver solver(model, Prescribe(model.mesh(), OnSurface(size), linear), team);
    const StaticSolution solution = solver.Solve({}, {.tolerance = 1e-13});
    EXPECT_LT(LargestError(model.mesh(), solution.displacement, linear), 1e-10);
    const Mat3 e = 0.5 * (A + A.transpose());
    const double mu = 3e4 / 2.8, lambda = 2 * mu * 0.4 / 0.2;
    for (const SymmetricTensor& stress : StressAtCentres(model, solution.displacement)) {
      EXPECT_NEAR(stress[0], 2 * mu * e(0, 0) + lambda * e.trace(), 1e-9 * lambda);
      EXPECT_NEAR(stress[4], 2 * mu * e(1, 2), 1e-9 * lambda);
    }
  }
}

// A bar pulled by a traction: E, the stress and the lateral contraction; faces, forces and body forces that add up.
TEST(Static, TractionOfABarGivesItsStressExactly) {
  const GridIndex size = {20, 4, 5};
  const VoxelGrid grid = BoxGrid(size, {1e-3, 2e-3, 1e-3});
  const VoxelModel model(grid, {{3e4, 0.3}}, Dilatation::kFull);
  const VoxelMesh& mesh = model.mesh();
  const std::vector<VoxelSupport> supports = {{NodesInBox(mesh, {0, 0, 0}, {0, 4, 5}), {true, false, false}},
                                              {NodesInBox(mesh, {0, 0, 0}, {20, 0, 5}), {false, true, false}},
                                              {NodesInBox(mesh, {0, 0, 0}, {20, 4, 0}), {false, false, true}}};
  VoxelLoads loads;
  loads.tractions = {{OuterFaces(grid, 1, {0, 0, 0}, {20, 4, 5}), Vec3(300, 0, 0)}};
  ThreadTeam team(1);
  VoxelStaticSolver solver(model, supports, team);
  const StaticSolution solution = solver.Solve(loads, {.tolerance = 1e-13});
  EXPECT_LT(LargestError(mesh, solution.displacement,
                         [](const Vec3& X) { return Vec3(0.01 * X[0], -0.003 * X[1], -0.003 * X[2]); }),
            1e-10);
  for (const SymmetricTensor& stress : StressAtCentres(model, solution.displacement)) {
    EXPECT_NEAR(stress[0], 300, 1e-7);
    EXPECT_NEAR(stress[1], 0, 1e-7);
  }
  const double force = 300 * 8e-3 * 5e-3;
  EXPECT_NEAR(solution.energy, 0.5 * force * 0.01 * 20e-3, 1e-10 * force);
}

TEST(Loads, HaveTheirResultants) {
  const VoxelGrid grid = SpongeGrid({6, 5, 7}, {1e-3, 2e-3, 3e-3});
  const VoxelModel model(grid, {{1, 0.3}, {2, 0.3}}, Dilatation::kFull);
  VoxelLoads loads;
  loads.body_force = {1, 2, 3};
  loads.nodal_forces = {{NodesInBox(model.mesh(), {0, 0, 0}, {6, 5, 1}), Vec3(4, 0, -1)}};
  const std::vector<VoxelFace> faces = OuterFaces(grid, 3, {0, 0, 0}, {6, 5, 7});
  loads.tractions = {{faces, Vec3(0, 100, 0)}};
  VoxelField<double> f(model.mesh().nodes());
  AddForces(model, loads, f);
  Vec3 sum = Vec3::Zero();
  for (std::int32_t n = 0; n < f.nodes(); ++n) sum += f.At(n);
  const Vec3 expected = 6e-9 * model.mesh().voxels() * Vec3(1, 2, 3) + Vec3(4, 0, -1) +
                        Vec3(0, 100 * 3e-6 * static_cast<double>(faces.size()), 0);
  EXPECT_LT((sum - expected).norm(), 1e-12 * expected.norm());
}

TEST(Static, ReactionsBalanceLoads) {
  const GridIndex size = {8, 8, 12};
  const VoxelGrid grid = BoxGrid(size, Vec3::Constant(1e-3));
  const VoxelModel model(grid, {{3e4, 0.45}}, Dilatation::kFull);
  ThreadTeam team(1);
  VoxelStaticSolver solver(model, {{NodesInBox(model.mesh(), {0, 0, 0}, {8, 8, 0})}}, team);
  VoxelLoads loads;
  loads.body_force = {100, 0, -1e4};
  loads.nodal_forces = {{{{8, 8, 12}}, Vec3(0, 1e-3, 0)}};
  const StaticSolution solution = solver.Solve(loads, {.tolerance = 1e-11});
  ASSERT_TRUE(solution.iterations.converged);
  Vec3 sum = Vec3::Zero();
  for (std::int32_t n = 0; n < model.mesh().nodes(); ++n) sum += solution.reaction.At(n);
  const Vec3 load = 8 * 8 * 12 * 1e-9 * loads.body_force + Vec3(0, 1e-3, 0);
  EXPECT_LT((sum + load).norm(), 1e-9 * load.norm());
}

// Rigid motions of the supports cause no stress.
TEST(Static, RigidMotionGivesNoStress) {
  const GridIndex size = {9, 6, 13};
  const VoxelGrid grid = BoxGrid(size, {1e-3, 1.5e-3, 1e-3});
  const Vec3 omega(0.01, -0.02, 0.03);
  const Displacement rigid = [&](const Vec3& X) { return Vec3(Vec3(1e-3, 2e-3, 3e-3) + omega.cross(X)); };
  ThreadTeam team(1);
  for (const Dilatation dilatation : {Dilatation::kFull, Dilatation::kMean}) {
    const VoxelModel model(grid, {{3e4, 0.49}}, dilatation);
    VoxelStaticSolver solver(model,
                             Prescribe(
                                 model.mesh(), [](const GridIndex& at) { return at[2] == 0; }, rigid),
                             team);
    const StaticSolution solution = solver.Solve({}, {.tolerance = 1e-13});
    EXPECT_LT(LargestError(model.mesh(), solution.displacement, rigid), 1e-10);
    for (const SymmetricTensor& stress : StressAtCentres(model, solution.displacement)) {
      for (const double s : stress) EXPECT_NEAR(s, 0, 3e4 * 1e-10);
    }
  }
}

// Displacements grad phi of a harmonic phi are in equilibrium for any moduli. All outer nodes of a cube are prescribed,
// the inner ones are free. (Not a polynomial, because nodal values of cubic ones are exact.)
TEST(Static, CubeConvergesWithTheSquareOfTheSpacing) {
  const Displacement exact = [](const Vec3& X) {
    const double e = 1e-2 * std::exp(2.5 * X[2]), x = 1.5 * X[0], y = 2 * X[1];
    return Vec3(-1.5 * e * std::sin(x) * std::cos(y), -2 * e * std::cos(x) * std::sin(y),
                2.5 * e * std::cos(x) * std::cos(y));
  };
  ThreadTeam team(1);
  for (const Dilatation dilatation : {Dilatation::kFull, Dilatation::kMean}) {
    std::vector<double> errors;
    for (const std::int32_t n : {8, 16, 32}) {
      const VoxelGrid grid = BoxGrid({n, n, n}, Vec3::Constant(1.0 / n));
      const VoxelModel model(grid, {{1, 0.4}}, dilatation);
      VoxelStaticSolver solver(model, Prescribe(model.mesh(), OnSurface({n, n, n}), exact), team);
      const StaticSolution solution = solver.Solve({}, {.tolerance = 1e-10});
      errors.push_back(LargestError(model.mesh(), solution.displacement, exact));
    }
    EXPECT_LT(errors[0], 0.01);
    EXPECT_NEAR(std::log2(errors[0] / errors[1]), 2, 0.25);
    EXPECT_NEAR(std::log2(errors[1] / errors[2]), 2, 0.15);
  }
}

// The plane cantilever under a parabolic shear force at its end, nu = 0 [Augarde & Deeks 2008, Finite Elem. Anal. Des.
// 44]: the exact displacements are prescribed at both ends, other sides are free. Nodal values are exact, so that the
// errors are those of trilinear interpolation, at the voxels' centres.
TEST(Static, CantileverConvergesWithTheSquareOfTheSpacing) {
  constexpr double kLength = 4, kDepth = 1, kE = 1e3, kP = 1;
  constexpr double kI = kDepth * kDepth * kDepth / 12;
  const Displacement exact = [](const Vec3& X) {
    const double x = X[0], y = X[1] - kDepth / 2;
    return Vec3(kP * y / (6 * kE * kI) * ((6 * kLength - 3 * x) * x + 2 * (y * y - kDepth * kDepth / 4)),
                -kP / (6 * kE * kI) * (kDepth * kDepth * x + (3 * kLength - x) * x * x), 0);
  };
  ThreadTeam team(1);
  std::vector<double> errors;
  for (const std::int32_t n : {4, 8, 16}) {
    const VoxelGrid grid = BoxGrid({4 * n, n, 2}, Vec3::Constant(kDepth / n));
    const VoxelModel model(grid, {{kE, 0}}, Dilatation::kFull);
    VoxelStaticSolver solver(
        model,
        Prescribe(
            model.mesh(), [n](const GridIndex& at) { return at[0] == 0 || at[0] == 4 * n; }, exact),
        team);
    const StaticSolution solution = solver.Solve({}, {.tolerance = 1e-11});
    EXPECT_LT(LargestError(model.mesh(), solution.displacement, exact), 1e-9);
    errors.push_back(LargestErrorAtCentres(model.mesh(), solution.displacement, exact));
    // The shear force.
    double force = 0;
    for (const GridIndex& at : NodesInBox(model.mesh(), {0, 0, 0}, {0, n, 2}))
      force += solution.reaction(model.mesh().NodeAt(at), 1);
    EXPECT_NEAR(force / (2 * kDepth / n), kP, 4.0 / (n * n)) << n;
  }
  EXPECT_NEAR(std::log2(errors[0] / errors[1]), 2, 0.25);
  EXPECT_NEAR(std::log2(errors[1] / errors[2]), 2, 0.15);
}

// Tip displacement of a cantilever of 10 x 1 x 1 under a force at its end, relative to the beam's P L^3 / (3 E I) (1 +
// 0.6 (1 + nu) (D/L)^2).
double TipOverBeam(double nu, Dilatation dilatation, std::int32_t n) {
  const VoxelGrid grid = BoxGrid({10 * n, n, n}, Vec3::Constant(1.0 / n));
  const VoxelModel model(grid, {{1e3, nu}}, dilatation);
  ThreadTeam team(1);
  VoxelStaticSolver solver(model, {{NodesInBox(model.mesh(), {0, 0, 0}, {0, n, n})}}, team);
  VoxelLoads loads;
  loads.tractions = {{OuterFaces(grid, 1, {0, 0, 0}, {10 * n, n, n}), Vec3(0, 0, 0.01)}};
  const StaticSolution solution = solver.Solve(loads, {.tolerance = 1e-8, .max_iterations = 3000});
  EXPECT_TRUE(solution.iterations.converged);
  const double tip = solution.displacement(model.mesh().NodeAt({10 * n, n / 2, n / 2}), 2);
  std::printf("nu %g, %s dilatation, %d across: %d iterations, %.4f of the beam's\n", nu,
              dilatation == Dilatation::kFull ? "full" : "mean", n, solution.iterations.iterations,
              tip / (0.01 * 1000 * 12 / 3e3 * (1 + 0.6 * (1 + nu) * 0.01)));
  return tip / (0.01 * 1000 * 12 / 3e3 * (1 + 0.6 * (1 + nu) * 0.01));
}

// K/mu = 1000.
TEST(MeanDilatation, DoesNotLockInBending) {
  constexpr double kNu = (3 * 1000.0 - 2) / (2 * (3 * 1000.0 + 1));
  const double compressible = TipOverBeam(0.3, Dilatation::kFull, 6);
  EXPECT_NEAR(compressible, 1, 0.05);
  EXPECT_NEAR(TipOverBeam(kNu, Dilatation::kMean, 6), compressible, 0.03);
  EXPECT_LT(TipOverBeam(kNu, Dilatation::kFull, 6), 0.7);  // locking, which mean dilatation avoids
}

// Balls of 10^4 times the stiffness in a cube, with many different sizes.
TEST(Static, StiffnessContrastOfTenThousandConverges) {
  constexpr std::int32_t kSide = 32;
  VoxelGrid grid = BoxGrid({kSide, kSide, kSide}, Vec3::Constant(1e-3));
  for (int ball = 0; ball < 40; ++ball) {
    const Vec3 centre =
        kSide * Vec3(HashedUnit(4 * ball) + 0.5, HashedUnit(4 * ball + 1) + 0.5, HashedUnit(4 * ball + 2) + 0.5);
    const double radius = 1 + 5 * (HashedUnit(4 * ball + 3) + 0.5);
    ForVoxels(grid, [&](std::size_t v, const GridIndex& at) {
      if ((Vec3(at[0], at[1], at[2]) + Vec3::Constant(0.5) - centre).norm() < radius) grid.material[v] = 2;
    });
  }
  const VoxelModel model(grid, {{3e4, 0.45}, {3e8, 0.3}}, Dilatation::kFull);
  ThreadTeam team(2);
  VoxelStaticSolver solver(
      model,
      {{NodesInBox(model.mesh(), {0, 0, 0}, {kSide, kSide, 0})},
       {NodesInBox(model.mesh(), {0, 0, kSide}, {kSide, kSide, kSide}), {true, true, true}, Vec3(1e-3, 0, 1e-3)}},
      team);
  const StaticSolution solution = solver.Solve({});
  EXPECT_TRUE(solution.iterations.converged);
  std::printf("contrast 1e4: %d iterations\n", solution.iterations.iterations);
  EXPECT_LT(solution.iterations.iterations, 150);
  // The forces of top and bottom are equal and opposite.
  double top = 0, bottom = 0;
  for (const GridIndex& at : NodesInBox(model.mesh(), {0, 0, 0}, {kSide, kSide, 0}))
    bottom += solution.reaction(model.mesh().NodeAt(at), 2);
  for (const GridIndex& at : NodesInBox(model.mesh(), {0, 0, kSide}, {kSide, kSide, kSide}))
    top += solution.reaction(model.mesh().NodeAt(at), 2);
  EXPECT_NEAR(top, -bottom, 1e-5 * top);
}

TEST(Static, HasTheSameBitsForAnyThreads) {
  VoxelGrid grid = SpongeGrid({40, 36, 44}, Vec3::Constant(1e-3));
  KeepLargestIsland(grid);
  const VoxelModel model(grid, {{3e4, 0.4}, {1e6, 0.3}}, Dilatation::kMean);
  ASSERT_GT(model.mesh().slabs().size(), 2u);
  const std::vector<VoxelSupport> supports = {{NodesInBox(model.mesh(), {0, 0, 0}, {40, 36, 3})}};
  VoxelLoads loads;
  loads.body_force = {1e3, 0, -1e4};
  std::vector<StaticSolution> solutions;
  for (const int threads : {1, 2, 3}) {
    ThreadTeam team(threads);
    solutions.push_back(VoxelStaticSolver(model, supports, team).Solve(loads));
    ASSERT_TRUE(solutions.back().iterations.converged);
    EXPECT_EQ(solutions.back().iterations.iterations, solutions[0].iterations.iterations);
    const VoxelField<double>& u = solutions.back().displacement;
    EXPECT_EQ(std::memcmp(u.data(), solutions[0].displacement.data(), u.size() * sizeof(double)), 0) << threads;
  }
}

// Interpolation to a finer level is exact for linear displacements, also where the coarse level has lost voxels.
TEST(CoarseAndFine, LinearDisplacementsAreInterpolatedExactly) {
  VoxelGrid grid = BoxGrid({12, 10, 9}, Vec3::Constant(1e-3));
  grid.material[grid.IndexOf({11, 9, 8})] = 0;
  const VoxelGrid coarse_grid = Coarsen(Coarsen(grid, 0.5), 0.9);
  const VoxelMesh fine(grid), coarse(coarse_grid);
  const auto linear = [](const Vec3& X) { return Vec3(0.1 * X[0] + 0.2 * X[2], -X[1], 3 * X[0] + 0.01); };
  VoxelField<double> u(coarse.nodes()), expected(fine.nodes());
  std::int32_t node = 0;
  for (const GridIndex& at : coarse.NodePlaces()) u.Add(node++, linear(PlaceOf(coarse, at)));
  node = 0;
  for (const GridIndex& at : fine.NodePlaces()) expected.Add(node++, linear(PlaceOf(fine, at)));
  const InterpolatedField interpolated = InterpolateToFine(coarse, u, fine, 4);
  const CoarseError error = ErrorOfCoarse(interpolated, expected);
  EXPECT_EQ(error.left_out, 0);
  EXPECT_LT(error.largest, 1e-15);
  // A known error.
  for (std::int32_t n = 0; n < fine.nodes(); ++n) expected(n, 1) *= 1.5;
  const CoarseError half = ErrorOfCoarse(interpolated, expected);
  EXPECT_NEAR(half.largest, 0.5 * 10e-3, 1e-15);
  EXPECT_GT(half.relative, 0.01);
}

}  // namespace
}  // namespace fascicle
