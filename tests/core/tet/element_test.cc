// The force on a tetrahedron's corners, by every equivalent formula of the papers.
#include "core/tet/element.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>

#include "core/materials/material.h"

namespace fascicle {
namespace {

constexpr double kRoundOff = 1e-12;

struct Element {
  NodalVector X, x;
  Tetrahedron corners = {0, 1, 2, 3};
  Mat3 Dm, Ds, F;
  double V = 0;

  explicit Element(unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> shift(-0.15, 0.15);
    X = {Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
    x = X;
    for (int n = 0; n < 4; ++n) {
      for (int c = 0; c < 3; ++c) {
        X[n][c] += shift(random);
        x[n][c] += shift(random);
      }
    }
    Dm = EdgeMatrix(X, corners);
    Ds = EdgeMatrix(x, corners);
    F = Ds * Dm.inverse();
    V = Dm.determinant() / 6;
  }

  Mat3 StressOf() const { return NeoHookean(std::array{1e4, 0.3}).Stress(F, {}); }
};

// The faces opposite each corner, counter-clockwise from outside.
constexpr int kFaces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

Vec3 AreaVector(const NodalVector& points, const int face[3]) {
  return 0.5 * (points[face[1]] - points[face[0]]).cross(points[face[2]] - points[face[0]]);
}

double LargestCornerDifference(const CornerValues& a, const CornerValues& b) {
  double largest = 0, scale = 0;
  for (int n = 0; n < 4; ++n) {
    largest = std::max(largest, (a[n] - b[n]).norm());
    scale = std::max(scale, a[n].norm());
  }
  return largest / scale;
}

class ElementTest : public ::testing::TestWithParam<unsigned> {
 protected:
  Element element_{GetParam()};

  CornerValues Forces(const Mat3& P) const {
    CornerValues forces;
    SetCornerForces(P, element_.Dm.inverse(), element_.V, forces);
    return forces;
  }
};

// [Teran 2003, 4]: f_i = -1/3 P (sum of A_j N_j over the three rest faces at i).
TEST_P(ElementTest, FaceAreaForm) {
  const Mat3 P = element_.StressOf();
  CornerValues by_faces;
  for (int i = 0; i < 4; ++i) {
    Vec3 sum = Vec3::Zero();
    for (int j = 0; j < 4; ++j) {
      if (j != i) sum += AreaVector(element_.X, kFaces[j]);
    }
    by_faces[i] = -P * sum / 3;
  }
  EXPECT_LT(LargestCornerDifference(by_faces, Forces(P)), kRoundOff);
}

// The same with Cauchy stress and the faces of the deformed tetrahedron.
TEST_P(ElementTest, CauchyForm) {
  const Mat3 P = element_.StressOf();
  const Mat3 sigma = P * element_.F.transpose() / element_.F.determinant();
  CornerValues by_faces;
  for (int i = 0; i < 4; ++i) {
    Vec3 sum = Vec3::Zero();
    for (int j = 0; j < 4; ++j) {
      if (j != i) sum += AreaVector(element_.x, kFaces[j]);
    }
    by_faces[i] = -sigma * sum / 3;
  }
  EXPECT_LT(LargestCornerDifference(by_faces, Forces(P)), kRoundOff);
}

// Linear finite elements: f_a = -V P grad N_a, with N_a from N_a(X_b) = delta_ab.
TEST_P(ElementTest, LinearFiniteElements) {
  const Mat3 P = element_.StressOf();
  Eigen::Matrix4d vertices;
  for (int n = 0; n < 4; ++n) vertices.row(n) << 1, element_.X[n].transpose();
  const Eigen::Matrix4d coefficients = vertices.inverse();  // column a: constant and gradient of N_a
  CornerValues by_gradients;
  for (int a = 0; a < 4; ++a) by_gradients[a] = -element_.V * P * coefficients.col(a).tail<3>();
  EXPECT_LT(LargestCornerDifference(by_gradients, Forces(P)), kRoundOff);
}

// f = -dW/dx. The St. Venant-Kirchhoff energy is a polynomial of degree four along any line, so that the five-point
// difference is exact at any step except for round-off.
TEST_P(ElementTest, MinusGradientOfEnergy) {
  const StVenantKirchhoff law(std::array{1e4, 0.3});
  const auto energy = [&](int n, int c, double shift) {
    NodalVector moved = element_.x;
    moved[n][c] += shift;
    return element_.V * law.Energy(EdgeMatrix(moved, element_.corners) * element_.Dm.inverse(), {});
  };
  const double h = 0.25;
  CornerValues by_difference;
  for (int n = 0; n < 4; ++n) {
    for (int c = 0; c < 3; ++c) {
      const double near = energy(n, c, h) - energy(n, c, -h);
      const double far = energy(n, c, 2 * h) - energy(n, c, -2 * h);
      by_difference[n][c] = -(8 * near - far) / (12 * h);
    }
  }
  EXPECT_LT(LargestCornerDifference(by_difference, Forces(law.Stress(element_.F, {}))), kRoundOff);
}

// [Teran 2003, 3]: Dm^T G Dm = (Ds^T Ds - Dm^T Dm) / 2, compared through dot products of edges.
TEST_P(ElementTest, GeometricStrain) {
  const Mat3 G = 0.5 * (element_.F.transpose() * element_.F - Mat3::Identity());
  const Mat3 by_edges = 0.5 * (element_.Ds.transpose() * element_.Ds - element_.Dm.transpose() * element_.Dm);
  EXPECT_LT((element_.Dm.transpose() * G * element_.Dm - by_edges).norm(), kRoundOff * element_.Ds.squaredNorm());
}

// Viscous stress: zero if the element only rotates, whatever its deformation; power = S : Edot >= 0.
TEST_P(ElementTest, ViscousStress) {
  const Vec3 spin(1.5, -2, 0.7);
  Mat3 W;
  W << 0, -spin[2], spin[1], spin[2], 0, -spin[0], -spin[1], spin[0], 0;
  const ViscousStress turning(element_.F, W * element_.F, 3, 5);
  EXPECT_LT(turning.S.norm(), 1e-14 * 8 * W.norm() * element_.F.squaredNorm());

  const Mat3 rate = Mat3::Random();
  const ViscousStress viscous(element_.F, rate, 3, 5);
  const Mat3 E_rate = 0.5 * (element_.F.transpose() * rate + rate.transpose() * element_.F);
  EXPECT_NEAR(viscous.power, viscous.S.cwiseProduct(E_rate).sum(), kRoundOff * viscous.power);
  EXPECT_GT(viscous.power, 0);
  EXPECT_LT((viscous.S - (6 * E_rate + 5 * E_rate.trace() * Mat3::Identity())).norm(), kRoundOff * viscous.S.norm());
}

INSTANTIATE_TEST_SUITE_P(RandomElements, ElementTest, ::testing::Range(1u, 21u));

}  // namespace
}  // namespace fascicle
