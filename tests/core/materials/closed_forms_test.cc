// Laws against closed forms and against FEBio.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <span>
#include <vector>

#include "core/materials/material.h"
#include "core/materials/uniaxial_curve.h"
#include "tests/support/law_values.h"
#include "tests/support/paths.h"

namespace fascicle {
namespace {

constexpr std::array kStretches = {0.7, 0.85, 0.99, 1.01, 1.2, 1.6, 2.0};

constexpr double kYoung = 2e5;
constexpr double kPoisson = 0.3;
constexpr double kMu = kYoung / (2 * (1 + kPoisson));
constexpr double kLambda = kYoung * kPoisson / ((1 + kPoisson) * (1 - 2 * kPoisson));

Material YoungLaw(const char* name) { return FindLaw(name)->make(std::array{kYoung, kPoisson}); }

Mat3 Stress(const Material& material, const Mat3& F, const FibreState& fibre = {}) {
  return std::visit([&](const auto& law) { return law.Stress(F, fibre); }, material);
}

// --- Rigid sides: F = diag(1, 1, s) ---

TEST(RigidSides, StressAlongTheStretch) {
  for (const double s : kStretches) {
    const Mat3 F = Vec3(1, 1, s).asDiagonal();
    const double M = kLambda + 2 * kMu;
    EXPECT_NEAR(Stress(YoungLaw("linear_elastic"), F)(2, 2), M * (s - 1), 1e-9 * kYoung);
    EXPECT_NEAR(Stress(YoungLaw("corotated_linear"), F)(2, 2), M * (s - 1), 1e-9 * kYoung);
    EXPECT_NEAR(Stress(YoungLaw("st_venant_kirchhoff"), F)(2, 2), M * s * (s * s - 1) / 2, 1e-9 * kYoung);
    EXPECT_NEAR(Stress(YoungLaw("neo_hookean"), F)(2, 2), kMu * (s - 1 / s) + kLambda * std::log(s) / s, 1e-9 * kYoung);
  }
}

// --- Simple shear: F = I + g e_x e_y ---

TEST(SimpleShear, ShearStress) {
  const Material mooney_rivlin = FindLaw("mooney_rivlin")->make(std::array{3e4, 1e4, 8e7});
  for (const double g : {0.1, 0.5, 2.0}) {
    Mat3 F = Mat3::Identity();
    F(0, 1) = g;
    // J = 1, so sigma = P F^T; both are linear in the shear.
    EXPECT_NEAR((Stress(YoungLaw("neo_hookean"), F) * F.transpose())(0, 1), kMu * g, 1e-9 * kYoung);
    EXPECT_NEAR((Stress(mooney_rivlin, F) * F.transpose())(0, 1), 2 * (3e4 + 1e4) * g, 1e-9 * 8e4);
  }
}

// --- Tension with free sides ---

TEST(UniaxialTension, LinearLaws) {
  for (const double s : kStretches) {
    for (const char* name : {"linear_elastic", "corotated_linear"}) {
      const UniaxialPoint p = UniaxialTension(YoungLaw(name), 0, s);
      ASSERT_TRUE(p.converged);
      EXPECT_NEAR(p.lateral_stretch, 1 - kPoisson * (s - 1), 1e-12);
      EXPECT_NEAR(p.nominal_stress, kYoung * (s - 1), 1e-8 * kYoung);
    }
  }
}

TEST(UniaxialTension, StVenantKirchhoff) {
  for (const double s : kStretches) {
    const UniaxialPoint p = UniaxialTension(YoungLaw("st_venant_kirchhoff"), 0, s);
    const double lateral_squared = 1 - kPoisson * (s * s - 1);
    ASSERT_TRUE(p.converged) << s;
    EXPECT_NEAR(p.lateral_stretch, std::sqrt(lateral_squared), 1e-12);
    EXPECT_NEAR(p.nominal_stress, kYoung * s * (s * s - 1) / 2, 1e-8 * kYoung);
    EXPECT_NEAR(p.volume_ratio, lateral_squared * s, 1e-12);
    EXPECT_NEAR(p.cauchy_stress, p.nominal_stress / lateral_squared, 1e-8 * kYoung);
  }
}

TEST(UniaxialTension, NeoHookean) {
  for (const double s : kStretches) {
    const UniaxialPoint p = UniaxialTension(YoungLaw("neo_hookean"), 0, s);
    ASSERT_TRUE(p.converged);
    const double l = p.lateral_stretch;
    // sigma_xx = 0 gives lambda ln J = mu (1 - l^2), and so sigma_zz = mu (s^2 - l^2) / J.
    EXPECT_NEAR(kLambda * std::log(l * l * s), kMu * (1 - l * l), 1e-9 * kMu);
    EXPECT_NEAR(p.cauchy_stress, kMu * (s * s - l * l) / p.volume_ratio, 1e-9 * kMu);
  }
}

// As K grows, the result approaches the incompressible one, sigma = 2 (s^2 - 1/s) (c1 + c2/s), with an error of mu/K.
TEST(UniaxialTension, IncompressibleMooneyRivlin) {
  for (const double K : {1e8, 1e9}) {
    const Material material = FindLaw("mooney_rivlin")->make(std::array{3e4, 1e4, K});
    for (const double s : kStretches) {
      const UniaxialPoint p = UniaxialTension(material, 0, s);
      ASSERT_TRUE(p.converged);
      const double expected = 2 * (s * s - 1 / s) * (3e4 + 1e4 / s);
      EXPECT_NEAR(p.cauchy_stress / expected, 1, 3 * 8e4 / K);
      // K ln(J)/J = sigma/3, so sigma differs by mu/K.
      const double size = std::abs(expected);
      EXPECT_NEAR(p.volume_ratio, 1 + expected / (3 * K), size * (size + 8e4) / (K * K));
      EXPECT_NEAR(p.lateral_stretch, 1 / std::sqrt(s), 3 * 8e4 / K);
    }
  }
}

// Problem b of the FEBio references, homogeneous case: a 10 mm cube, c1, c2, K in MPa, every point of the load path.
TEST(UniaxialTension, MooneyRivlinAgreesWithFebio) {
  const std::filesystem::path reference = testing::ReferenceFolder();
  std::ifstream in(reference / "febio/b_uniaxial_mooney_rivlin.json");
  if (!in) GTEST_SKIP() << "no reference results in " << reference << "; set FASCICLE_REFERENCE";
  const nlohmann::json problem = nlohmann::json::parse(in);
  const auto& parameters = problem.at("material");
  const Material material =
      FindLaw("mooney_rivlin")
          ->make(std::array{1e6 * parameters.at("c1").get<double>(), 1e6 * parameters.at("c2").get<double>(),
                            1e6 * parameters.at("K").get<double>()});
  int points = 0;
  for (const auto& row : problem.at("runs_homogeneous").at(0).at("path_t_stretch_lateralstretch_Fz_J")) {
    const UniaxialPoint p = UniaxialTension(material, 0, row.at(1).get<double>());
    ASSERT_TRUE(p.converged);
    const double force = p.nominal_stress * 0.01 * 0.01;  // [N] on 10 mm x 10 mm
    EXPECT_NEAR(p.lateral_stretch, row.at(2).get<double>(), 1e-7);
    EXPECT_NEAR(force, row.at(3).get<double>(), 1e-6);
    EXPECT_NEAR(p.volume_ratio, row.at(4).get<double>(), 1e-7);
    ++points;
  }
  EXPECT_EQ(points, 11);
  const UniaxialPoint end = UniaxialTension(material, 0, 1.5);
  EXPECT_NEAR(end.nominal_stress * 1e-4, 7.7368966, 1e-6);
  EXPECT_NEAR(end.volume_ratio, 1.0004837, 1e-7);
}

// --- Muscle and tendon along the fibre ---

// Incompressible limit: the matrix is Mooney-Rivlin, and the fibre adds lambda F2' = smax r (alpha f_act(r) +
// f_pass(r)), r = s / lo.
TEST(Muscle, CauchyStressAlongTheFibre) {
  constexpr double kBulk = 1e12, kPeak = 3e5;
  for (const double lo : {1.0, 1.4}) {
    const Material muscle = FindLaw("muscle")->make(std::array{500.0, 500.0, kBulk, kPeak, lo, 0.05, 6.6, 1.4});
    for (const double alpha : {0.0, 0.3, 1.0}) {
      for (const double s : {0.7, 0.9, 1.0, 1.1, 1.4, 1.68}) {
        const double r = s / lo;
        const double active = r <= 0.4 || r >= 1.6 ? 0
                              : r <= 0.6           ? 9 * std::pow(r - 0.4, 2)
                              : r < 1.4            ? 1 - 4 * std::pow(1 - r, 2)
                                                   : 9 * std::pow(r - 1.6, 2);
        const double p3 = 0.05 * 6.6 * std::exp(6.6 * 0.4);
        const double p4 = 0.05 * (std::exp(6.6 * 0.4) - 1) - 1.4 * p3;
        const double passive = r <= 1 ? 0 : r < 1.4 ? 0.05 * (std::exp(6.6 * (r - 1)) - 1) : p3 * r + p4;
        const double expected = 2 * (s * s - 1 / s) * (500 + 500 / s) + kPeak * r * (alpha * active + passive);
        const UniaxialPoint p = UniaxialTension(muscle, alpha, s);
        ASSERT_TRUE(p.converged);
        EXPECT_NEAR(p.cauchy_stress, expected, 1e-4 * kPeak) << "lo " << lo << " alpha " << alpha << " s " << s;
      }
    }
  }
}

TEST(Muscle, PeaksAtTheOptimalStretch) {
  const Muscle muscle(std::array{500.0, 500.0, 1e7, 3e5, 1.4, 0.05, 6.6, 1.4});
  EXPECT_NEAR(muscle.FibreStress(1.4, 1), 3e5, 1e-6);
  EXPECT_EQ(muscle.FibreStress(1.4, 0), 0);
  EXPECT_NEAR(muscle.FibreStress(1.0, 1), 3e5 / 1.4 * (1 - 4 * std::pow(1 - 1 / 1.4, 2)), 1e-6);
  EXPECT_EQ(muscle.FibreStress(0.5, 1), 0);
}

// The rest state has zero energy at every activation; shortening of an active muscle from there releases energy of the
// fibre.
TEST(Muscle, NoEnergyAtRestWhateverTheActivation) {
  const Muscle muscle(std::array{500.0, 500.0, 1e7, 3e5, 1.4, 0.05, 6.6, 1.4});
  for (const double alpha : {0.0, 0.5, 1.0}) {
    EXPECT_NEAR(muscle.Energy(Mat3::Identity(), {Vec3::UnitX(), alpha}), 0, 1e-9);
  }
  const double s = 0.9;
  const Mat3 F = Vec3(s, 1 / std::sqrt(s), 1 / std::sqrt(s)).asDiagonal();
  EXPECT_LT(muscle.Energy(F, {Vec3::UnitX(), 1}), muscle.Energy(F, {Vec3::UnitX(), 0}));
}

// Incompressible limit: the matrix is Mooney-Rivlin, the fibre adds lambda F2' and the Cauchy stress T0 alpha s^2 of
// the active second Piola-Kirchhoff stress.
TEST(TransIsoMooneyRivlin, CauchyStressAlongTheFibre) {
  constexpr double kBulk = 1e12, kC3 = 2e4, kC4 = 8, kC5 = 1.5e6, kLamMax = 1.2, kActive = 3e5;
  const Material law =
      FindLaw("trans_iso_mooney_rivlin")->make(std::array{3e4, 1e4, kC3, kC4, kC5, kLamMax, kBulk, kActive});
  const double c6 = kC3 * (std::exp(kC4 * (kLamMax - 1)) - 1) - kC5 * kLamMax;
  for (const double alpha : {0.0, 0.4, 1.0}) {
    for (const double s : {0.8, 1.0, 1.1, 1.2, 1.3, 1.5}) {
      const double passive = s <= 1 ? 0 : s < kLamMax ? kC3 * (std::exp(kC4 * (s - 1)) - 1) : kC5 * s + c6;
      const double expected = 2 * (s * s - 1 / s) * (3e4 + 1e4 / s) + passive + kActive * alpha * s * s;
      const UniaxialPoint p = UniaxialTension(law, alpha, s);
      ASSERT_TRUE(p.converged);
      EXPECT_NEAR(p.cauchy_stress, expected, 1e-5 * kActive) << "alpha " << alpha << " s " << s;
    }
  }
}

// The active stress is T0 alpha/J (F a0)(F a0)^T with nothing across the fibre: no pressure, unlike the isochoric one.
TEST(TransIsoMooneyRivlin, ActiveStressIsAlongTheFibreOnly) {
  const TransIsoMooneyRivlin law(std::array{3e4, 1e4, 2e4, 8.0, 1.5e6, 1.2, 8e6, 3e5});
  Mat3 F;
  F << 1.1, 0.2, 0, -0.1, 0.9, 0.3, 0, 0.1, 1.3;
  const Vec3 a0 = Vec3(1, 2, -2) / 3;
  const Mat3 active = law.Stress(F, {a0, 0.7}) - law.Stress(F, {a0, 0});
  const Vec3 a = F * a0;
  EXPECT_LE((active * F.transpose() - 0.7 * 3e5 * a * a.transpose()).norm(), 1e-9 * 3e5);
}

// Slack fibres bear no stress: below stretch one, tendon and passive muscle are Mooney-Rivlin.
TEST(Fibres, CarryNoCompression) {
  const FibreState fibre{Vec3::UnitZ(), 0};
  const Mat3 F = Vec3(1.1, 1.05, 0.9).asDiagonal();
  const Mat3 tendon = Stress(FindLaw("tendon")->make(std::array{5e4, 5e4, 5e8, 2.7e6, 46.4, 1.03}), F, fibre);
  const Mat3 matrix = Stress(FindLaw("mooney_rivlin")->make(std::array{5e4, 5e4, 5e8}), F, fibre);
  EXPECT_LE((tendon - matrix).norm(), 1e-15 * matrix.norm());
}

TEST(Tendon, CauchyStressAlongTheFibre) {
  constexpr double kBulk = 1e13;
  const Tendon law(std::array{5e4, 5e4, kBulk, 2.7e6, 46.4, 1.03});
  const double slope = 2.7e6 * 46.4 * std::exp(46.4 * 0.03);
  for (const double s : {1.01, 1.02, 1.03, 1.05}) {
    const double fibre =
        s < 1.03 ? 2.7e6 * (std::exp(46.4 * (s - 1)) - 1) : 2.7e6 * (std::exp(46.4 * 0.03) - 1) + slope * (s - 1.03);
    EXPECT_NEAR(law.FibreStress(s), fibre, 1e-9 * fibre);
    const UniaxialPoint p = UniaxialTension(law, 0, s);
    ASSERT_TRUE(p.converged);
    EXPECT_NEAR(p.cauchy_stress, fibre + 2 * (s * s - 1 / s) * (5e4 + 5e4 / s), 1e-4 * fibre);
  }
}

// --- The uniaxial curve ---

TEST(UniaxialCurve, GivesEveryStretchAndSaysWhereThereIsNoAnswer) {
  // A linear law narrows to nothing at 1 + 1/nu.
  const std::vector<double> stretches = {0.5, 1, 2, 4.2, 4.4, 6};
  const std::vector<UniaxialPoint> points = UniaxialCurve(YoungLaw("linear_elastic"), {}, stretches);
  ASSERT_EQ(points.size(), stretches.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(points[i].stretch, stretches[i]);
    EXPECT_EQ(points[i].converged, stretches[i] < 1 + 1 / kPoisson) << stretches[i];
    EXPECT_EQ(std::isnan(points[i].nominal_stress), !points[i].converged);
    EXPECT_EQ(std::isnan(points[i].lateral_stretch), !points[i].converged);
  }
  EXPECT_NEAR(points[1].nominal_stress, 0, 1e-9 * kYoung);
}

TEST(UniaxialCurve, ConvergesForEveryLawWithItsDefaultsOverTheUsualRange) {
  for (const LawInfo& law : Laws()) {
    const Material material = law.make(testing::UsableValues(law));
    for (const double alpha : {0.0, 0.5, 1.0}) {
      for (double s = 0.6; s < 1.8; s += 0.01) {
        const UniaxialPoint p = UniaxialTension(material, alpha, s);
        ASSERT_TRUE(p.converged) << law.name << ' ' << alpha << ' ' << s;
        const Mat3 F = Vec3(p.lateral_stretch, p.lateral_stretch_y, s).asDiagonal();
        const Mat3 P = Stress(material, F, {Vec3::UnitZ(), alpha});
        const double tolerance =
            1e-12 * std::visit([](const auto& m) { return m.BulkModulus() + m.ShearModulus(); }, material) +
            1e-12 * P.norm();
        EXPECT_NEAR(P(0, 0), 0, tolerance);
        EXPECT_NEAR(P(1, 1), 0, tolerance);
        EXPECT_EQ(P(0, 1), 0);
      }
    }
  }
}

}  // namespace
}  // namespace fascicle
