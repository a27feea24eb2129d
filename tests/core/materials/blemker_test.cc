// Blemker's muscle and tendon against closed forms: the invariants of pure modes of strain, and the published curves.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "core/materials/blemker_muscle.h"
#include "core/materials/blemker_tendon.h"
#include "core/materials/muscle.h"
#include "core/materials/spd.h"
#include "core/materials/tendon.h"
#include "tests/support/law_checks.h"

namespace fascicle {
namespace {

// G1, G2, K, smax, lo, P1, P2, transition.
const std::array kPublishedMuscle = {500.0, 500.0, 1e7, 3e5, 1.4, 0.05, 6.6, 1.4};
const std::array kPublishedTendon = {5e4, 5e4, 5e8, 2.7e6, 46.4, 1.03};

TEST(Blemker, DefaultsAreThePublishedParameters) {
  for (std::size_t i = 0; i < kPublishedMuscle.size(); ++i) {
    EXPECT_EQ(BlemkerMuscle::kParameters[i].default_value, kPublishedMuscle[i]);
  }
  for (std::size_t i = 0; i < kPublishedTendon.size(); ++i) {
    EXPECT_EQ(BlemkerTendon::kParameters[i].default_value, kPublishedTendon[i]);
  }
}

// Each invariant measures one mode. Fibres sliding along each other by g: B1 = g. Stretches s and 1/s across: B2 = 2 ln
// s; simple shear g across: B2 = arcosh(1 + g^2/2). Stretched along the fibres: nothing but the fibre energy. A shear
// that turns the fibres: B1 = g/(1 + g^2) and B2 = ln(1 + g^2)/2.
TEST(Blemker, EnergiesOfPureModes) {
  constexpr double kG1 = 700, kG2 = 300;
  const BlemkerMuscle law(std::array{kG1, kG2, 1e7, 0.0, 1.4, 0.05, 6.6, 1.4});
  const auto energy = [&](const Mat3& F) { return law.Energy(F, {Vec3::UnitZ(), 0.5}); };
  const auto sheared = [](int i, int j, double g) {
    Mat3 F = Mat3::Identity();
    F(i, j) = g;
    return F;
  };
  for (const double g : {1e-9, 1e-4, 0.01, 0.2, 0.45, 1.0, 3.0}) {
    // Relative to the energy, and to the round-off of a stretch.
    const auto near = [&](double expected) { return 1e-12 * expected + 1e-12 * kG1 * g + 1e-13 * kG1; };
    const double along = kG1 * g * g;
    EXPECT_NEAR(energy(sheared(2, 0, g)), along, near(along)) << g;
    const double turned = kG1 * g * g / std::pow(1 + g * g, 2) + kG2 * std::pow(0.5 * std::log1p(g * g), 2);
    EXPECT_NEAR(energy(sheared(0, 2, g)), turned, near(turned)) << g;
    const double across = kG2 * std::pow(2 * std::asinh(g / 2), 2);
    EXPECT_NEAR(energy(sheared(0, 1, g)), across, near(across)) << g;
    const double s = 1 + g;
    const double stretched = kG2 * 4 * std::log(s) * std::log(s);
    EXPECT_NEAR(energy(Vec3(s, 1 / s, 1).asDiagonal()), stretched, near(stretched)) << g;
    EXPECT_NEAR(energy(Vec3(1 / std::sqrt(s), 1 / std::sqrt(s), s).asDiagonal()), 0, 1e-12 * kG1 * (1 + g)) << g;
  }
}

// Shear stresses of small and large strains: 2 G1 g along the fibres, 2 G2 d(arcosh^2)/dg across.
TEST(Blemker, ShearStresses) {
  const BlemkerMuscle law(std::array{700.0, 300.0, 1e7, 0.0, 1.4, 0.05, 6.6, 1.4});
  for (const double g : {1e-6, 0.1, 0.8, 2.0}) {
    Mat3 F = Mat3::Identity();
    F(2, 0) = g;
    EXPECT_NEAR(law.Stress(F, {Vec3::UnitZ(), 0})(2, 0), 2 * 700 * g, 1e-9 * 700 * (1e-3 + g));
    F = Mat3::Identity();
    F(0, 1) = g;
    const double expected = 2 * 300 * 2 * std::asinh(g / 2) / std::sqrt(1 + g * g / 4);
    EXPECT_NEAR(law.Stress(F, {Vec3::UnitZ(), 0})(0, 1), expected, 1e-9 * 300 * (1e-3 + g));
  }
}

// The fibres are those of Muscle and Tendon, whatever the matrix: in a bar of constant volume sigma_zz - sigma_xx is
// the fibre stress alone.
TEST(Blemker, FibreStressesAreThePublishedOnes) {
  const BlemkerMuscle muscle(kPublishedMuscle);
  const BlemkerTendon tendon(kPublishedTendon);
  const Muscle plain_muscle(std::array{500.0, 500.0, 1e7, 3e5, 1.4, 0.05, 6.6, 1.4});
  const Tendon plain_tendon(std::array{5e4, 5e4, 5e8, 2.7e6, 46.4, 1.03});
  const auto difference = [](const auto& law, double l, double alpha) {
    const Mat3 F = Vec3(1 / std::sqrt(l), 1 / std::sqrt(l), l).asDiagonal();
    const Mat3 sigma = law.WithVolumeModulus(0).Stress(F, {Vec3::UnitZ(), alpha}) * F.transpose();
    return sigma(2, 2) - sigma(0, 0);
  };
  for (double l = 0.6; l < 2.2; l += 0.05) {
    for (const double alpha : {0.0, 0.4, 1.0}) {
      EXPECT_NEAR(difference(muscle, l, alpha), plain_muscle.FibreStress(l, alpha), 1e-9 * 3e5);
      EXPECT_EQ(muscle.FibreStress(l, alpha), plain_muscle.FibreStress(l, alpha));
    }
  }
  for (double l = 0.9; l < 1.1; l += 0.005) {
    EXPECT_NEAR(difference(tendon, l, 0), plain_tendon.FibreStress(l), 1e-9 * 2.7e6);
  }
  // At the optimal stretch the whole peak stress; at the end of its toe the tendon bears L1 (exp(0.03 L2) - 1).
  EXPECT_NEAR(muscle.FibreStress(1.4, 1), 3e5, 1e-9 * 3e5);
  EXPECT_NEAR(tendon.FibreStress(1.03), 2.7e6 * std::expm1(46.4 * 0.03), 1e-6);
}

// Projected tangents of any state are positive semidefinite, those of a body at rest without projection.
TEST(Blemker, TangentsCanBeProjected) {
  laws::Sampler sampler(5);
  const BlemkerMuscle law(kPublishedMuscle);
  int indefinite = 0;
  for (int i = 0; i < 200; ++i) {
    const laws::Sample sample = sampler.Draw(i, 0.7);
    const Mat9 tangent = law.Tangent(sample.F, sample.fibre);
    const double largest = tangent.cwiseAbs().maxCoeff();
    const auto least = [](const Mat9& H) { return Eigen::SelfAdjointEigenSolver<Mat9>(H).eigenvalues()[0]; };
    indefinite += least(tangent) < -1e-9 * largest;
    EXPECT_GT(least(NearestPositive(tangent)), -1e-12 * largest);
  }
  EXPECT_GT(indefinite, 10);
}

// A prestretched fibre: its stress is that at p lambda, and the matrix does not notice.
TEST(Blemker, PrestretchLeavesTheMatrix) {
  const BlemkerTendon law(kPublishedTendon);
  laws::Sampler sampler(9);
  for (int i = 0; i < 20; ++i) {
    const laws::Sample sample = sampler.Draw(4 * i, 0);  // near rest
    const double l = (sample.F * sample.fibre.direction).norm() / std::cbrt(sample.F.determinant());
    const double prestretch = 1.04 / l;  // on the line beyond the toe
    const BlemkerTendon slack(std::array{5e4, 5e4, 5e8, 0.0, 46.4, 1.03});
    const double matrix = slack.Energy(sample.F, sample.fibre);
    const double taut = law.Energy(sample.F, {prestretch * sample.fibre.direction, 0});
    const double exact =
        law.Energy(Vec3(1 / std::sqrt(1.04), 1 / std::sqrt(1.04), 1.04).asDiagonal(), {Vec3::UnitZ(), 0});
    EXPECT_NEAR(taut - matrix, exact, 1e-9 * (exact + matrix));
  }
}

}  // namespace
}  // namespace fascicle
