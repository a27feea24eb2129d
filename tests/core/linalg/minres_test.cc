// MINRES against known solutions.
#include "core/linalg/minres.h"

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

#include <random>

namespace fascicle {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd RandomOrthogonal(int size, std::mt19937& random) {
  std::normal_distribution<double> normal;
  MatrixXd A(size, size);
  for (double& a : A.reshaped()) a = normal(random);
  return Eigen::HouseholderQR<MatrixXd>(A).householderQ();
}

const auto kNone = [](const VectorXd& r, VectorXd& z) { z = r; };

TEST(Minres, SolvesIndefiniteSystemsInAsManyStepsAsThereAreEigenvalues) {
  std::mt19937 random(1);
  const MatrixXd Q = RandomOrthogonal(30, random);
  VectorXd eigenvalues(30);
  for (int i = 0; i < 30; ++i) eigenvalues[i] = std::array{-3.0, -1.0, 0.5, 2.0, 7.0}[i % 5];
  const MatrixXd A = Q * eigenvalues.asDiagonal() * Q.transpose();
  const VectorXd expected = Q.col(3) + 2 * Q.col(17) - Q * VectorXd::Ones(30);
  VectorXd x;
  const MinresResult result =
      Minres([&](const VectorXd& v, VectorXd& y) { y = A * v; }, kNone, A * expected, 1e-12, 100, x);
  EXPECT_TRUE(result.converged);
  EXPECT_EQ(result.iterations, 5);
  EXPECT_LT((x - expected).norm(), 1e-10);
}

// The residual never grows, and the reported one is the true one.
TEST(Minres, ItsResidualIsTheTrueOne) {
  std::mt19937 random(2);
  const MatrixXd Q = RandomOrthogonal(40, random);
  const MatrixXd A = Q * VectorXd::LinSpaced(40, -4.1, 9).asDiagonal() * Q.transpose();
  const VectorXd b = VectorXd::LinSpaced(40, -1, 2), scale = VectorXd::LinSpaced(40, 0.5, 3);
  const auto apply = [&](const VectorXd& v, VectorXd& y) { y = A * v; };
  const auto scaled = [&](const VectorXd& r, VectorXd& z) { z = scale.cwiseProduct(r); };
  double before = 1;
  for (const int iterations : {1, 3, 8, 20}) {
    VectorXd x;
    const MinresResult result = Minres(apply, scaled, b, 0, iterations, x);
    const VectorXd r = b - A * x;
    const double size = std::sqrt(r.dot(scale.cwiseProduct(r)) / b.dot(scale.cwiseProduct(b)));
    EXPECT_NEAR(result.residual, size, 1e-10);
    EXPECT_LE(size, before + 1e-12);
    before = size;
  }
  EXPECT_LT(before, 0.5);
}

// A singular matrix with a right-hand side in its range has a solution.
TEST(Minres, SingularButConsistent) {
  std::mt19937 random(3);
  const MatrixXd Q = RandomOrthogonal(20, random);
  VectorXd eigenvalues = VectorXd::LinSpaced(20, -2, 3);
  eigenvalues.head(4).setZero();
  const MatrixXd A = Q * eigenvalues.asDiagonal() * Q.transpose();
  const VectorXd b = A * VectorXd::Ones(20);
  VectorXd x;
  EXPECT_TRUE(Minres([&](const VectorXd& v, VectorXd& y) { y = A * v; }, kNone, b, 1e-10, 100, x).converged);
  EXPECT_LT((A * x - b).norm(), 1e-9 * b.norm());
}

TEST(Minres, NothingOnTheRightIsZero) {
  VectorXd x;
  const MinresResult result =
      Minres([](const VectorXd& v, VectorXd& y) { y = v; }, kNone, VectorXd::Zero(5), 1e-10, 10, x);
  EXPECT_TRUE(result.converged);
  EXPECT_EQ(result.iterations, 0);
  EXPECT_EQ(x, VectorXd::Zero(5));
}

// With M and the Schur complement as preconditioner a saddle point has three eigenvalues: 1 and (1 +- sqrt 5)/2
// [Murphy, Golub & Wathen 2000].
TEST(Minres, ASaddlePointTakesThreeSteps) {
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  MatrixXd G(6, 25);
  for (double& g : G.reshaped()) g = normal(random);
  const VectorXd M = VectorXd::LinSpaced(25, 0.1, 5), b = VectorXd::LinSpaced(31, -1, 1);
  const MatrixXd S = G * M.cwiseInverse().asDiagonal() * G.transpose(), S_inverse = S.inverse();
  const auto apply = [&](const VectorXd& v, VectorXd& y) {
    y.resize(31);
    y << M.cwiseProduct(v.head(25)) + G.transpose() * v.tail(6), G * v.head(25);
  };
  const auto precondition = [&](const VectorXd& r, VectorXd& z) {
    z.resize(31);
    z << r.head(25).cwiseQuotient(M), S_inverse * r.tail(6);
  };
  VectorXd x, y;
  const MinresResult result = Minres(apply, precondition, b, 1e-10, 50, x);
  EXPECT_TRUE(result.converged);
  EXPECT_LE(result.iterations, 3);
  apply(x, y);
  EXPECT_LT((y - b).norm(), 1e-9);
}

}  // namespace
}  // namespace fascicle
