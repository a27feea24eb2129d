#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/linalg/conjugate_gradient.h"
#include "core/linalg/lanczos.h"

namespace fascicle {
namespace {

constexpr std::size_t kNodes = 200;
const Vec3 kWeights(1, 2, 5);

// Chains of springs between neighbours, one per axis, with fixed ends: the matrix has 2 on the diagonal and -1 beside
// it, times the weight of the axis. Its eigenvalues are weight * (2 - 2 cos(k pi / (n + 1))), k = 1 .. n.
void ApplyChain(const NodalVector& p, NodalVector& q) {
  q.resize(p.size());
  for (std::size_t n = 0; n < p.size(); ++n) {
    Vec3 sum = 2 * p[n];
    if (n > 0) sum -= p[n - 1];
    if (n + 1 < p.size()) sum -= p[n + 1];
    q[n] = kWeights.cwiseProduct(sum);
  }
}

TEST(LanczosTest, LargestEigenvalueOfChain) {
  ThreadTeam team(2);
  LanczosWorkspace workspace;
  const double exact = 5 * (2 - 2 * std::cos(kNodes * std::numbers::pi / (kNodes + 1)));
  const NodalVector ones(kNodes, Vec3::Ones());
  const double estimate = LargestEigenvalue(team, ApplyChain, ones, 0.01, workspace);
  EXPECT_GE(estimate, exact * (1 - 1e-9));
  EXPECT_LE(estimate, exact * 1.01);
  // Scaled by W on both sides; an axis with W = 0 is excluded.
  const NodalVector without_z(kNodes, Vec3(3, 3, 0));
  EXPECT_NEAR(LargestEigenvalue(team, ApplyChain, without_z, 0.01, workspace), exact * 9 * 2 / 5, 0.01 * exact * 4);
  const NodalVector nothing(kNodes, Vec3::Zero());
  EXPECT_EQ(LargestEigenvalue(team, ApplyChain, nothing, 0.01, workspace), 0);
}

// The solution of the chain under unit force is a parabola: x_n = (n + 1)(N - n) / (2 weight).
TEST(ConjugateGradientTest, ChainUnderUnitForce) {
  ThreadTeam team(2);
  CgWorkspace workspace;
  const NodalVector b(kNodes, Vec3::Ones());
  NodalVector x(kNodes, Vec3::Zero());
  NodalVector inverse_diagonal(kNodes, (2 * kWeights).cwiseInverse());
  const CgResult result = ConjugateGradient(team, ApplyChain, inverse_diagonal, b, 1e-12, 1000, x, workspace);
  EXPECT_TRUE(result.converged);
  EXPECT_LE(result.iterations, static_cast<int>(kNodes));
  for (std::size_t n = 0; n < kNodes; ++n) {
    const double parabola = 0.5 * static_cast<double>((n + 1) * (kNodes - n));
    EXPECT_LT((x[n].cwiseProduct(kWeights) - Vec3::Constant(parabola)).norm(), 1e-8 * parabola);
  }
}

// A component with inverse diagonal zero keeps its value, which enters the other equations.
TEST(ConjugateGradientTest, GivenComponents) {
  ThreadTeam team(1);
  CgWorkspace workspace;
  const NodalVector b(kNodes, Vec3::Zero());
  NodalVector x(kNodes, Vec3::Zero());
  NodalVector inverse_diagonal(kNodes, (2 * kWeights).cwiseInverse());
  inverse_diagonal[99].setZero();
  x[99] = Vec3(1, -2, 3);
  EXPECT_TRUE(ConjugateGradient(team, ApplyChain, inverse_diagonal, b, 1e-12, 1000, x, workspace).converged);
  EXPECT_EQ(x[99], Vec3(1, -2, 3));
  for (std::size_t n = 0; n < 99; ++n) EXPECT_LT((x[n] - static_cast<double>(n + 1) / 100 * x[99]).norm(), 1e-9);
}

TEST(ConjugateGradientTest, SaysWhenItDoesNotConverge) {
  ThreadTeam team(1);
  CgWorkspace workspace;
  const NodalVector b(kNodes, Vec3::Ones()), inverse_diagonal(kNodes, (2 * kWeights).cwiseInverse());
  NodalVector x(kNodes, Vec3::Zero());
  const CgResult few = ConjugateGradient(team, ApplyChain, inverse_diagonal, b, 1e-12, 5, x, workspace);
  EXPECT_FALSE(few.converged);
  EXPECT_EQ(few.iterations, 5);
  NodalVector nan(kNodes, Vec3::Constant(std::nan("")));
  EXPECT_FALSE(ConjugateGradient(team, ApplyChain, inverse_diagonal, nan, 1e-12, 5, x, workspace).converged);
}

}  // namespace
}  // namespace fascicle
