// Corotated bricks: VoxelModel with VoxelRotation::kLarge.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstring>
#include <numbers>

#include "core/voxel/fields.h"
#include "core/voxel/rotated_bricks.h"
#include "core/voxel/static_solver.h"
#include "tests/support/voxel_scenes.h"

namespace fascicle {
namespace {

using testing::BoxGrid;
using testing::RandomField;
using testing::SpongeGrid;

const VoxelMaterial kRotatedMuscle = {3e4, 0.4};

VoxelField<double> Times(double factor, VoxelField<double> u) {
  for (std::size_t k = 0; k < u.size(); ++k) u.data()[k] *= factor;
  return u;
}

// Displacements of a rotation about the origin.
VoxelField<double> Turned(const VoxelMesh& mesh, const Mat3& Q) {
  VoxelField<double> u(mesh.nodes());
  std::int32_t n = 0;
  for (const GridIndex& at : mesh.NodePlaces()) {
    const Vec3 X = mesh.spacing().cwiseProduct(Vec3(at[0], at[1], at[2]));
    u.Add(n++, Q * X - X);
  }
  return u;
}

const Mat3 kQuarterAndMore = Eigen::AngleAxisd(2.3, Vec3(1, 2, -0.5).normalized()).toRotationMatrix();

struct RotatedSponge {
  explicit RotatedSponge(Dilatation dilatation, const GridIndex& size = {9, 6, 7})
      : grid(SpongeGrid(size, {0.9e-3, 1.1e-3, 1.6e-3})),
        model(grid, {kRotatedMuscle, {1e6, 0.3}}, dilatation, VoxelRotation::kLarge),
        bricks(model.K()),
        R(model.mesh().voxels()),
        f(model.mesh().nodes()) {}
  // A large rotation, and some percent of strain in every brick.
  VoxelField<double> Deformed(double strain) const {
    VoxelField<double> u = Turned(model.mesh(), kQuarterAndMore);
    const VoxelField<double> random = RandomField<double>(u.nodes());
    for (std::size_t k = 0; k < u.size(); ++k) u.data()[k] += strain * 1e-3 * random.data()[k];
    return u;
  }
  double Energy(const VoxelField<double>& u) { return bricks.Forces(u, team, R, f); }
  VoxelGrid grid;
  VoxelModel model;
  RotatedBricks bricks;
  BrickRotations<double> R;
  VoxelField<double> f;
  ThreadTeam team{1};
};

TEST(RotatedBricks, RigidMotionGivesNoForceAndNoStress) {
  for (const Dilatation dilatation : {Dilatation::kFull, Dilatation::kMean}) {
    RotatedSponge s(dilatation);
    VoxelField<double> u = Turned(s.model.mesh(), kQuarterAndMore);
    for (std::int32_t n = 0; n < u.nodes(); ++n) u.Add(n, Vec3(1e-3, -2e-3, 3e-3));
    const double energy = s.Energy(u);
    VoxelField<double> linear(u.nodes());
    s.model.K().Apply(u, s.team, linear);
    const double size = std::sqrt(Dot(s.team, linear, linear));
    EXPECT_LT(std::sqrt(Dot(s.team, s.f, s.f)), 1e-13 * size);
    EXPECT_LT(energy, 1e-25 * Dot(s.team, linear, u));
    EXPECT_LT((s.R.At(3) - kQuarterAndMore).norm(), 1e-13);
    for (const SymmetricTensor& stress : StressAtCentres(s.model, u)) {
      for (const double component : stress) EXPECT_LT(std::abs(component), 1e6 * 1e-13);
    }
  }
}

TEST(RotatedBricks, AreLinearBricksWhereNothingTurns) {
  RotatedSponge s(Dilatation::kFull);
  const VoxelField<double> u = Times(1e-9 * 1e-3, RandomField<double>(s.f.nodes()));
  s.Energy(u);
  VoxelField<double> linear(u.nodes());
  s.model.K().Apply(u, s.team, linear);
  for (std::size_t k = 0; k < u.size(); ++k) linear.data()[k] -= s.f.data()[k];
  EXPECT_LT(std::sqrt(Dot(s.team, linear, linear)), 1e-6 * std::sqrt(Dot(s.team, s.f, s.f)));
}

TEST(RotatedBricks, ForcesAreTheDerivativeOfTheEnergy) {
  for (const Dilatation dilatation : {Dilatation::kFull, Dilatation::kMean}) {
    RotatedSponge s(dilatation);
    const VoxelField<double> u = s.Deformed(0.2), w = RandomField<double>(u.nodes());
    constexpr double kStep = 1e-8;
    VoxelField<double> beside(u.nodes());
    double energies[2];
    for (const int side : {0, 1}) {
      for (std::size_t k = 0; k < u.size(); ++k) beside.data()[k] = u.data()[k] + (2 * side - 1) * kStep * w.data()[k];
      energies[side] = s.Energy(beside);
    }
    s.Energy(u);
    const double slope = Dot(s.team, s.f, w);
    EXPECT_NEAR((energies[1] - energies[0]) / (2 * kStep), slope, 1e-6 * std::sqrt(Dot(s.team, s.f, s.f)));
  }
}

TEST(RotatedBricks, TangentIsTheDerivativeOfTheForces) {
  for (const Dilatation dilatation : {Dilatation::kFull, Dilatation::kMean}) {
    RotatedSponge s(dilatation);
    const VoxelField<double> u = s.Deformed(0.2);
    VoxelField<double> w(u.nodes()), product(u.nodes()), other(u.nodes()), beside(u.nodes()), first(u.nodes());
    for (std::size_t k = 0; k < u.size(); ++k) w.data()[k] = HashedUnit(k + 77);
    for (int d = 0; d < 3; ++d) {
      for (std::size_t k = u.nodes(); k < u.stride(); ++k) w.component(d)[k] = 0;
    }
    constexpr double kStep = 1e-8;
    for (const int side : {0, 1}) {
      for (std::size_t k = 0; k < u.size(); ++k) beside.data()[k] = u.data()[k] + (2 * side - 1) * kStep * w.data()[k];
      s.Energy(beside);
      if (side == 0) first = s.f;
    }
    VoxelField<double> difference = s.f;
    for (std::size_t k = 0; k < u.size(); ++k) difference.data()[k] = (s.f.data()[k] - first.data()[k]) / (2 * kStep);
    s.Energy(u);
    s.bricks.ApplyTangent(u, s.R, w, s.team, product);
    const double size = std::sqrt(Dot(s.team, product, product));
    for (std::size_t k = 0; k < u.size(); ++k) difference.data()[k] -= product.data()[k];
    EXPECT_LT(std::sqrt(Dot(s.team, difference, difference)), 1e-6 * size);
    // Symmetric.
    const VoxelField<double> v = RandomField<double>(u.nodes());
    s.bricks.ApplyTangent(u, s.R, v, s.team, other);
    EXPECT_NEAR(Dot(s.team, v, product), Dot(s.team, w, other), 1e-12 * size * std::sqrt(Dot(s.team, v, v)));
  }
}

TEST(RotatedBricks, ForcesHaveNeitherResultantNorTorque) {
  RotatedSponge s(Dilatation::kFull);
  const VoxelField<double> u = s.Deformed(0.3);
  s.Energy(u);
  Vec3 sum = Vec3::Zero(), torque = Vec3::Zero();
  double size = 0;
  std::int32_t n = 0;
  for (const GridIndex& at : s.model.mesh().NodePlaces()) {
    const Vec3 x = s.model.mesh().spacing().cwiseProduct(Vec3(at[0], at[1], at[2])) + u.At(n), f = s.f.At(n++);
    sum += f;
    torque += x.cross(f);
    size += f.norm();
  }
  EXPECT_LT(sum.norm(), 1e-13 * size);
  EXPECT_LT(torque.norm(), 1e-13 * size * 1e-2);  // of a body of 10 mm
}

TEST(RotatedBricks, HaveTheSameBitsForAnyThreadsAndInstructionSet) {
  const RotatedSponge s(Dilatation::kFull, {45, 40, 50});
  const VoxelMesh& mesh = s.model.mesh();
  ASSERT_GT(mesh.slabs().size(), 2u);
  const VoxelField<double> u = s.Deformed(0.3), w = RandomField<double>(u.nodes());
  std::vector<VoxelField<double>> results;
  std::vector<double> energies;
  for (const InstructionSet set : kInstructionSets) {
    if (!IsAvailable(set)) continue;
    for (const int threads : {1, 3}) {
      ThreadTeam team(threads);
      const VoxelOperator<double> K(s.model.stiffness(), &VoxelKernelsFor(set));
      RotatedBricks bricks(K);
      BrickRotations<double> R(mesh.voxels());
      VoxelField<double> f(u.nodes()), product(u.nodes());
      energies.push_back(bricks.Forces(u, team, R, f));
      bricks.ApplyTangent(u, R, w, team, product);
      results.push_back(f);
      results.push_back(product);
    }
  }
  for (std::size_t k = 2; k < results.size(); ++k) {
    EXPECT_EQ(std::memcmp(results[k].data(), results[k % 2].data(), results[k].size() * sizeof(double)), 0) << k;
    EXPECT_EQ(energies[k / 2], energies[0]);
  }
}

// The end of the elastica: a cantilever of unit length and bending stiffness under a lateral force p, integrated by a
// Runge-Kutta method from the clamp; the slope theta obeys theta'' = -p cos(theta), theta'(1) = 0.
Eigen::Vector2d ElasticaTip(double p) {
  constexpr int kSteps = 2000;
  const auto shoot = [p](double curvature) {
    Eigen::Vector4d y(0, curvature, 0, 0);  // theta, theta', along, across
    const auto slope = [p](const Eigen::Vector4d& at) {
      return Eigen::Vector4d(at[1], -p * std::cos(at[0]), std::cos(at[0]), std::sin(at[0]));
    };
    constexpr double h = 1.0 / kSteps;
    for (int k = 0; k < kSteps; ++k) {
      const Eigen::Vector4d k1 = slope(y), k2 = slope(y + h / 2 * k1), k3 = slope(y + h / 2 * k2),
                            k4 = slope(y + h * k3);
      y += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    }
    return y;
  };
  double low = 0, high = p;  // the moment at the clamp is at most p
  for (int k = 0; k < 60; ++k) {
    const double middle = (low + high) / 2;
    (shoot(middle)[1] < 0 ? low : high) = middle;
  }
  return shoot(low).tail<2>();
}

TEST(RotatedBricks, ElasticaHasItsTabulatedTip) {
  // [Bisshopp & Drucker 1945; Mattiasson 1981, Int. J. Numer. Meth. Engng 17, table 1], P L^2/(E I) = 1 and 10.
  EXPECT_LT((ElasticaTip(1) - Eigen::Vector2d(1 - 0.05643, 0.30172)).norm(), 1e-5);
  EXPECT_LT((ElasticaTip(10) - Eigen::Vector2d(1 - 0.55500, 0.81061)).norm(), 1e-5);
}

// A cantilever of 20 x 1 x 1 bent by 75 degrees, against the elastica; the error is of second order in the spacing.
TEST(LargeRotation, CantileverBendsAsTheElastica) {
  constexpr double kLoad = 5;  // P L^2/(E I)
  const Eigen::Vector2d exact = 20 * ElasticaTip(kLoad);
  ThreadTeam team(2);
  std::vector<double> errors;
  for (const std::int32_t n : {2, 4}) {
    const VoxelGrid grid = BoxGrid({20 * n, n, n}, Vec3::Constant(1.0 / n));
    const VoxelModel model(grid, {{1e3, 0}}, Dilatation::kFull, VoxelRotation::kLarge);
    VoxelStaticSolver solver(model, {{NodesInBox(model.mesh(), {0, 0, 0}, {0, n, n})}}, team);
    VoxelLoads loads;
    loads.tractions = {{OuterFaces(grid, 1, {0, 0, 0}, {20 * n, n, n}), Vec3(0, 0, kLoad * 1e3 / 12 / 400)}};
    const StaticSolution solution = solver.Solve(loads, {.tolerance = 1e-9, .max_iterations = 5000});
    const Vec3 tip = solution.displacement.At(model.mesh().NodeAt({20 * n, n / 2, n / 2}));
    std::printf("%d across: %d Newton iterations, %d of conjugate gradients, tip (%.4f, %.4f), elastica (%.4f, %.4f)\n",
                n, solution.iterations.newton_iterations, solution.iterations.iterations, 20 + tip[0], tip[2], exact[0],
                exact[1]);
    ASSERT_TRUE(solution.iterations.converged);
    EXPECT_NEAR(tip[1], 0, 1e-6);
    errors.push_back((Eigen::Vector2d(20 + tip[0], tip[2]) - exact).norm() / 20);
  }
  EXPECT_LT(errors[1], 0.01);
  EXPECT_NEAR(std::log2(errors[0] / errors[1]), 2, 0.4);
}

// The clamp rotates by 120 degrees in steps, and the body follows without stress.
TEST(LargeRotation, ATurnedClampTakesTheBodyAlong) {
  const VoxelGrid grid = BoxGrid({12, 4, 3}, {1e-3, 1.5e-3, 1e-3});
  const VoxelModel model(grid, {kRotatedMuscle}, Dilatation::kMean, VoxelRotation::kLarge);
  ThreadTeam team(1);
  VoxelStaticSolver solver(model, {{NodesInBox(model.mesh(), {0, 0, 0}, {0, 4, 3})}}, team);
  VoxelField<double> none(model.mesh().nodes()), u = none;
  for (int step = 1; step <= 4; ++step) {
    const Mat3 Q = Eigen::AngleAxisd(step * std::numbers::pi / 6, Vec3(1, 1, 2).normalized()).toRotationMatrix();
    const VoxelField<double> exact = Turned(model.mesh(), Q);
    const StaticSolution solution = solver.Solve(none, exact, {.tolerance = 1e-10}, &u);
    ASSERT_TRUE(solution.iterations.converged);
    u = solution.displacement;
    std::printf("%d degrees: %d Newton iterations, %d of conjugate gradients, |r| %g\n", 30 * step,
                solution.iterations.newton_iterations, solution.iterations.iterations, solution.iterations.residual);
    for (std::int32_t n = 0; n < u.nodes(); ++n) EXPECT_LT((u.At(n) - exact.At(n)).norm(), 1e-10);
    for (const SymmetricTensor& stress : StressAtCentres(model, u)) {
      for (const double component : stress) EXPECT_LT(std::abs(component), 3e4 * 1e-7);
    }
  }
}

TEST(LargeRotation, HasTheSameBitsForAnyThreads) {
  VoxelGrid grid = SpongeGrid({40, 36, 44}, Vec3::Constant(1e-3));
  KeepLargestIsland(grid);
  const VoxelModel model(grid, {{3e4, 0.4}, {1e6, 0.3}}, Dilatation::kMean, VoxelRotation::kLarge);
  ASSERT_GT(model.mesh().slabs().size(), 2u);
  const std::vector<VoxelSupport> supports = {{NodesInBox(model.mesh(), {0, 0, 0}, {40, 36, 3})}};
  VoxelLoads loads;
  loads.body_force = {5e4, 0, -1e4};
  std::vector<StaticSolution> solutions;
  for (const int threads : {1, 3}) {
    ThreadTeam team(threads);
    solutions.push_back(VoxelStaticSolver(model, supports, team).Solve(loads, {.tolerance = 1e-5}));
    ASSERT_TRUE(solutions.back().iterations.converged);
    EXPECT_GT(solutions.back().iterations.newton_iterations, 1);
  }
  const VoxelField<double>& u = solutions[0].displacement;
  EXPECT_EQ(std::memcmp(u.data(), solutions[1].displacement.data(), u.size() * sizeof(double)), 0);
}

}  // namespace
}  // namespace fascicle
