// Yeoh, Ogden, Fung-type and Holzapfel-Gasser-Ogden against closed forms of incompressible bodies and published curves.
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/materials/material.h"
#include "core/materials/uniaxial_curve.h"
#include "tests/support/law_checks.h"

namespace fascicle {
namespace {

constexpr double kRigidBulk = 1e12;  // [Pa]; at J = 1 it adds a pressure only
constexpr std::array kTestedStretches = {0.6, 0.85, 0.999, 1.0, 1.001, 1.2, 1.7, 2.5};

// sigma_ii - sigma_jj of a diagonal F with J = 1 up to round-off, which the bulk modulus would amplify.
template <class Law>
double StressDifference(const Law& law, const Vec3& stretches, int i, int j, const FibreState& fibre = {}) {
  const Mat3 F = stretches.asDiagonal();
  const Mat3 sigma = law.WithVolumeModulus(0).Stress(F, fibre) * F.transpose() / stretches.prod();
  return sigma(i, i) - sigma(j, j);
}
Vec3 Uniaxial(double s) { return {s, 1 / std::sqrt(s), 1 / std::sqrt(s)}; }
Vec3 Equibiaxial(double s) { return {s, s, 1 / (s * s)}; }
Vec3 PureShear(double s) { return {s, 1, 1 / s}; }

// sigma_xy of simple shear.
template <class Law>
double ShearStress(const Law& law, double g, const FibreState& fibre = {}) {
  Mat3 F = Mat3::Identity();
  F(0, 1) = g;
  return (law.Stress(F, fibre) * F.transpose())(0, 1);
}

// --- Yeoh: sigma_i - sigma_j = 2 (l_i^2 - l_j^2) W'(I1), in simple shear 2 g W' ---

TEST(Yeoh, ClosedForms) {
  constexpr double kC1 = 3e4, kC2 = -1e3, kC3 = 2e2;
  const Yeoh law(std::array{kC1, kC2, kC3, kRigidBulk});
  const auto slope = [](double x) { return kC1 + 2 * kC2 * x + 3 * kC3 * x * x; };
  for (const double s : kTestedStretches) {
    for (const Vec3& l : {Uniaxial(s), Equibiaxial(s), PureShear(s)}) {
      const double expected = 2 * (l[0] * l[0] - l[2] * l[2]) * slope(l.squaredNorm() - 3);
      EXPECT_NEAR(StressDifference(law, l, 0, 2), expected, 1e-10 * std::abs(expected) + 1e-10 * kC1) << s;
    }
    const double g = s - 1;
    EXPECT_NEAR(ShearStress(law, g), 2 * g * slope(g * g), 1e-12 * kC1);
  }
  EXPECT_EQ(law.ShearModulus(), 2 * kC1);
}

// --- Ogden: sigma_i - sigma_j = sum c/m (l_i^m - l_j^m) ---

struct OgdenTerm {
  double c, m;
};
constexpr std::array<OgdenTerm, 3> kOgdenTerms = {{{8e4, 1.3}, {600, 5}, {2e3, -2}}};

Ogden OgdenOf(const std::array<OgdenTerm, 3>& t, double bulk) {
  return Ogden(std::array{t[0].c, t[0].m, t[1].c, t[1].m, t[2].c, t[2].m, bulk});
}
double OgdenDifference(const std::array<OgdenTerm, 3>& terms, double l_i, double l_j) {
  double sum = 0;
  for (const OgdenTerm& t : terms) sum += t.c / t.m * (std::pow(l_i, t.m) - std::pow(l_j, t.m));
  return sum;
}

TEST(Ogden, ClosedForms) {
  const Ogden law = OgdenOf(kOgdenTerms, kRigidBulk);
  for (const double s : kTestedStretches) {
    for (const Vec3& l : {Uniaxial(s), Equibiaxial(s), PureShear(s)}) {
      for (const auto& [i, j] : {std::pair{0, 1}, std::pair{1, 2}, std::pair{0, 2}}) {
        const double expected = OgdenDifference(kOgdenTerms, l[i], l[j]);
        EXPECT_NEAR(StressDifference(law, l, i, j), expected, 1e-12 * (std::abs(expected) + 8e4)) << s;
      }
    }
    // Simple shear has the stretches l, 1, 1/l with l - 1/l = g, and sigma_xy = (sigma_1 - sigma_3)/(l + 1/l).
    const double l = s, g = l - 1 / l;
    EXPECT_NEAR(ShearStress(law, g), OgdenDifference(kOgdenTerms, l, 1 / l) / (l + 1 / l), 1e-11 * 8e4) << s;
  }
}

// The shear modulus at rest, from the stress of a small shear: half of the sum of the c.
TEST(Ogden, ShearModulusIsHalfOfTheCoefficients) {
  const Ogden law = OgdenOf(kOgdenTerms, kRigidBulk);
  EXPECT_DOUBLE_EQ(law.ShearModulus(), 0.5 * (8e4 + 600 + 2e3));
  const double g = 1e-5;
  EXPECT_NEAR(ShearStress(law, g) / g, law.ShearModulus(), 1e-8 * law.ShearModulus());
}

// The energy by its definition.
TEST(Ogden, EnergyIsTheSumOfPowers) {
  const Ogden law = OgdenOf(kOgdenTerms, 1e5);
  laws::Sampler sampler(5);
  for (int i = 0; i < 200; ++i) {
    const Mat3 F = sampler.Draw(i, 0).F;
    const double J = F.determinant();
    const Vec3 l = F.jacobiSvd().singularValues() / std::cbrt(J);
    double expected = 0.5 * 1e5 * std::log(J) * std::log(J);
    for (const OgdenTerm& t : kOgdenTerms) expected += t.c / (t.m * t.m) * (l.array().pow(t.m).sum() - 3);
    EXPECT_NEAR(law.Energy(F, {}), expected, 1e-11 * (expected + 8e4));
  }
}

// With exponents 2 and -2 it is Mooney-Rivlin with c/4, which knows no principal stretches: also where stretches
// coincide, or nearly do, in energy, stress and tangent.
TEST(Ogden, IsMooneyRivlinForExponentsTwoAlsoWhereStretchesCoincide) {
  const Ogden law = OgdenOf({{{12e4, 2}, {4e4, -2}, {0, 2}}}, 1e6);
  const MooneyRivlin expected(std::array{3e4, 1e4, 1e6});
  laws::Sampler sampler(3);
  for (const double gap : {0.0, 1e-17, 1e-15, 1e-12, 1e-9, 1e-7, 1e-5, 1e-3, 0.1, 1.0}) {
    for (const double s : {1.0, 1.5, 0.5}) {
      for (int i = 0; i < 20; ++i) {
        Mat3 F = Vec3(s, s * (1 + gap), i % 2 == 0 ? s : 1 / s).asDiagonal();
        if (i > 3) F = sampler.Rotation() * F * sampler.Rotation();
        const Mat9 tangent = expected.Tangent(F, {});
        EXPECT_LE((law.Tangent(F, {}) - tangent).norm(), 1e-13 * tangent.norm()) << gap << ' ' << s;
        EXPECT_LE((law.Stress(F, {}) - expected.Stress(F, {})).norm(), 1e-13 * tangent.norm()) << gap << ' ' << s;
        EXPECT_NEAR(law.Energy(F, {}), expected.Energy(F, {}), 1e-13 * tangent.norm()) << gap << ' ' << s;
      }
    }
  }
}

// The limit m = 0 is Hencky's law, c/2 sum (ln l)^2; nearby exponents give nearly the same.
TEST(Ogden, ExponentZeroIsTheLimit) {
  const Ogden zero = OgdenOf({{{8e4, 0}, {0, 2}, {0, 2}}}, kRigidBulk);
  for (const double s : kTestedStretches) {
    EXPECT_NEAR(StressDifference(zero, Uniaxial(s), 0, 1), 8e4 * 1.5 * std::log(s), 1e-11 * 8e4);
    EXPECT_NEAR(zero.Energy(Uniaxial(s).asDiagonal(), {}), 4e4 * 1.5 * std::pow(std::log(s), 2), 1e-9 * 8e4);
  }
  laws::Sampler sampler(3);
  for (int i = 0; i < 100; ++i) {
    const Mat3 F = sampler.Draw(i, 0).F;
    for (const double m : {1e-300, -1e-17, 1e-9}) {
      const Ogden near = OgdenOf({{{8e4, m}, {0, 2}, {0, 2}}}, 1e6);
      const Ogden limit = zero.WithVolumeModulus(1e6);
      EXPECT_NEAR(near.Energy(F, {}), limit.Energy(F, {}), 1e-8 * 8e4);
      EXPECT_LE((near.Stress(F, {}) - limit.Stress(F, {})).norm(), 1e-8 * 8e4);
      EXPECT_LE((near.Tangent(F, {}) - limit.Tangent(F, {})).norm(), 1e-8 * limit.Tangent(F, {}).norm());
    }
  }
}

// --- Rubber: L. R. G. Treloar 1944, Stress-strain data for vulcanised rubber under various types of deformation,
// Trans. Faraday Soc. 40, in the digits of P. Steinmann, M. Hossain, G. Possart 2012, Arch. Appl. Mech. 82 ---

struct Measured {
  double stretch, nominal;  // [1], [kg/cm^2]
};
constexpr double kKilogramPerSquareCentimetre = 98066.5;  // [Pa]
constexpr std::array<Measured, 24> kTreloarUniaxial = {
    {{1.02, 0.26}, {1.125, 1.37}, {1.24, 2.30}, {1.39, 3.23}, {1.585, 4.16}, {1.9, 5.10},  {2.18, 6.00}, {2.42, 6.90},
     {3.02, 8.80}, {3.57, 10.7},  {4.03, 12.5}, {4.76, 16.2}, {5.36, 19.9},  {5.75, 23.6}, {6.15, 27.4}, {6.4, 31.0},
     {6.6, 34.8},  {6.85, 38.5},  {7.05, 42.1}, {7.15, 45.8}, {7.25, 49.6},  {7.4, 53.3},  {7.5, 57.0},  {7.6, 64.4}}};
constexpr std::array<Measured, 16> kTreloarEquibiaxial = {{{1.03, 0.95},
                                                           {1.07, 1.60},
                                                           {1.12, 2.42},
                                                           {1.14, 2.62},
                                                           {1.2, 3.32},
                                                           {1.31, 4.43},
                                                           {1.42, 5.18},
                                                           {1.68, 6.60},
                                                           {1.94, 7.78},
                                                           {2.49, 9.79},
                                                           {3.03, 12.6},
                                                           {3.43, 14.7},
                                                           {3.75, 17.4},
                                                           {4.07, 20.1},
                                                           {4.26, 22.5},
                                                           {4.45, 24.7}}};

// Nominal stress along a stretched axis while the third axis is free [kg/cm^2].
template <class Law>
double Nominal(const Law& law, const Vec3& stretches) {
  return StressDifference(law, stretches, 0, 2) / stretches[0] / kKilogramPerSquareCentimetre;
}

// Ogden 1972: alpha = 1.3, 5, -2, mu = 6.3, 0.012, -0.1 kg/cm^2, chosen for Treloar's three tests together. In tension
// they are about 0.6 kg/cm^2 above the data near stretch 2, and fall below them beyond stretch 7, where the chains
// reach their full length.
TEST(Ogden, ReproducesTreloarsRubberWithOgdensParameters) {
  const auto term = [](double mu, double alpha) { return OgdenTerm{mu * alpha * kKilogramPerSquareCentimetre, alpha}; };
  const Ogden law = OgdenOf({term(6.3, 1.3), term(0.012, 5), term(-0.1, -2)}, kRigidBulk);
  // mu = sum mu_i alpha_i / 2 = 4.225 kg/cm^2, as Ogden gives.
  EXPECT_NEAR(law.ShearModulus() / kKilogramPerSquareCentimetre, 4.225, 1e-12);
  const auto expect_near = [&](const Measured& point, double nominal, double relative) {
    std::printf("%6.3f %8.3f %8.3f\n", point.stretch, point.nominal, nominal);
    EXPECT_NEAR(nominal, point.nominal, std::max(0.65, relative * point.nominal)) << point.stretch;
  };
  for (const Measured& point : kTreloarUniaxial) {
    if (point.stretch <= 7) expect_near(point, Nominal(law, Uniaxial(point.stretch)), 0.035);
  }
  for (const Measured& point : kTreloarEquibiaxial) expect_near(point, Nominal(law, Equibiaxial(point.stretch)), 0.06);
}

// Yeoh's three coefficients are linear in the stress: their least-squares fit to the same tension test. The law then
// has c2 < 0 < c3, as Yeoh 1993 found for rubber.
TEST(Yeoh, FitsTreloarsRubber) {
  Eigen::Matrix<double, kTreloarUniaxial.size(), 3> columns;
  Eigen::Matrix<double, kTreloarUniaxial.size(), 1> measured;
  for (std::size_t i = 0; i < kTreloarUniaxial.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      std::array<double, 4> values = {0, 0, 0, kRigidBulk};
      values[static_cast<std::size_t>(c)] = kKilogramPerSquareCentimetre;
      columns(static_cast<Eigen::Index>(i), c) = Nominal(Yeoh(values), Uniaxial(kTreloarUniaxial[i].stretch));
    }
    measured[static_cast<Eigen::Index>(i)] = kTreloarUniaxial[i].nominal;
  }
  const Vec3 c = columns.colPivHouseholderQr().solve(measured);
  std::printf("c1 %.5g, c2 %.5g, c3 %.5g kg/cm^2\n", c[0], c[1], c[2]);
  EXPECT_LT(c[1], 0);
  EXPECT_GT(c[2], 0);
  EXPECT_GT(c[1], -std::sqrt(3 * c[0] * c[2]));
  const Vec3 pascals = kKilogramPerSquareCentimetre * c;
  const Yeoh law(std::array{pascals[0], pascals[1], pascals[2], kRigidBulk});
  double sum = 0;
  for (const Measured& point : kTreloarUniaxial) {
    const double nominal = Nominal(law, Uniaxial(point.stretch));
    std::printf("%6.3f %8.3f %8.3f\n", point.stretch, point.nominal, nominal);
    sum += std::pow(nominal - point.nominal, 2);
  }
  // Over the whole test, to stretch 7.6: 2 % of the largest stress.
  EXPECT_LT(std::sqrt(sum / kTreloarUniaxial.size()), 0.02 * 64.4);
}

// --- Fung-type fibres ---

// Media and adventitia of a rabbit's carotid artery [Holzapfel, Gasser & Ogden 2000]: c = 3 and 0.3 kPa, k1 = 2.3632
// and 0.562 kPa, k2 = 0.8393 and 0.7112, with c1 = c/2; and a law with c2.
class FungFibreSets : public ::testing::TestWithParam<std::array<double, 4>> {};

TEST_P(FungFibreSets, ClosedForms) {
  const auto [c1, c2, k1, k2] = GetParam();
  const FungFibre law(std::array{c1, c2, k1, k2, kRigidBulk});
  // Cauchy stress along the fibre, 2 I4 dW/dI4.
  const auto fibre_stress = [k1 = k1, k2 = k2](double I4) {
    return I4 <= 1 ? 0 : 2 * I4 * k1 * (I4 - 1) * std::exp(k2 * (I4 - 1) * (I4 - 1));
  };
  const FibreState along{Vec3::UnitX(), 0}, oblique{Vec3(0.6, 0.8, 0), 0};
  for (const double s : kTestedStretches) {
    for (const Vec3& l : {Uniaxial(s), Equibiaxial(s), PureShear(s)}) {
      const double matrix = 2 * (l[0] * l[0] - l[2] * l[2]) * (c1 + c2 * l[1] * l[1]);
      const double expected = matrix + fibre_stress(l[0] * l[0]);
      EXPECT_NEAR(StressDifference(law, l, 0, 2, along), expected, 1e-10 * (std::abs(expected) + c1)) << s;
      // Fibres in the plane: a = F a0 = (0.6 l_x, 0.8 l_y).
      const double I4 = std::pow(0.6 * l[0], 2) + std::pow(0.8 * l[1], 2);
      const double inclined = matrix + fibre_stress(I4) * std::pow(0.6 * l[0], 2) / I4;
      EXPECT_NEAR(StressDifference(law, l, 0, 2, oblique), inclined, 1e-10 * (std::abs(inclined) + c1)) << s;
    }
    // Simple shear: a = (0.6 + 0.8 g, 0.8).
    const double g = s - 1, x = 0.6 + 0.8 * g, I4 = x * x + 0.64;
    const double expected = 2 * (c1 + c2) * g + fibre_stress(I4) * x * 0.8 / I4;
    EXPECT_NEAR(ShearStress(law, g, oblique), expected, 1e-10 * (std::abs(expected) + c1)) << s;
  }
}

INSTANTIATE_TEST_SUITE_P(Published, FungFibreSets,
                         ::testing::Values(std::array{1.5e3, 0.0, 2.3632e3, 0.8393},
                                           std::array{150.0, 0.0, 562.0, 0.7112}, std::array{3e4, 1e4, 2e4, 0.7}));

TEST(FungFibre, QuadraticInTheLimit) {
  const FungFibre law(std::array{3e4, 0.0, 2e4, 0.0, kRigidBulk});
  const Vec3 l = Uniaxial(1.5);
  const double I4 = l[0] * l[0];
  EXPECT_NEAR(StressDifference(law, l, 0, 2, {Vec3::UnitX(), 0}),
              2 * 3e4 * (I4 - l[2] * l[2]) + 2 * 2e4 * I4 * (I4 - 1), 1e-6);
  EXPECT_NEAR(law.WithVolumeModulus(0).Energy(l.asDiagonal(), {Vec3::UnitX(), 0}),
              3e4 * (l.squaredNorm() - 3) + 1e4 * (I4 - 1) * (I4 - 1), 1e-6);
}

// --- Holzapfel-Gasser-Ogden ---

// The adventitia of a human iliac artery, Gasser 2006, section 3: c = 7.64 kPa, k1 = 996.6 kPa, k2 = 524.6, gamma =
// 49.98 degrees, kappa = 0.226. Fibres along x (circumferential), the axis along z.
struct Adventitia {
  double c = 7640, k1 = 996600, k2 = 524.6, kappa = 0.226, gamma = 49.98 * std::numbers::pi / 180;

  HolzapfelGasserOgden Law(double bulk = kRigidBulk) const {
    return HolzapfelGasserOgden(std::array{c, k1, k2, kappa, gamma, 0.0, 0.0, 2.0, bulk});
  }
  // 2 dW/d(l_a^2) l_a^2 of stretches along x, y, z: the Cauchy stress up to a pressure. Both families stretch alike.
  Vec3 Stress(const Vec3& l) const {
    const Vec3 squares = l.array().square();
    const Vec3 direction(std::pow(std::cos(gamma), 2), 0, std::pow(std::sin(gamma), 2));
    const double E = kappa * (squares.sum() - 3) + (1 - 3 * kappa) * (direction.dot(squares) - 1);
    const double slope = E <= 0 ? 0 : k1 * E * std::exp(k2 * E * E);
    const Vec3 weight = Vec3::Constant(kappa) + (1 - 3 * kappa) * direction;
    return squares.array() * (c + 4 * slope * weight.array());
  }
};

TEST(HolzapfelGasserOgden, ClosedForms) {
  const FibreState fibre{Vec3::UnitX(), 0};
  for (const double kappa : {0.0, 0.226, 1.0 / 3}) {
    Adventitia adventitia;
    adventitia.kappa = kappa;
    for (const double s : {0.9, 0.99, 1.0, 1.01, 1.05, 1.1, 1.15}) {
      for (const Vec3& l : {Uniaxial(s), Equibiaxial(s), PureShear(s), Vec3(1 / s, 1, s), Vec3(s, 1 / (s * s), s)}) {
        const Vec3 expected = adventitia.Stress(l);
        for (const auto& [i, j] : {std::pair{0, 1}, std::pair{1, 2}, std::pair{0, 2}}) {
          EXPECT_NEAR(StressDifference(adventitia.Law(), l, i, j, fibre), expected[i] - expected[j],
                      1e-10 * (expected.norm() + adventitia.c))
              << kappa << ' ' << s;
        }
      }
    }
  }
}

// A strip along the fibre direction with free sides: the incompressible closed form has one unknown, the stretch in the
// plane, found by bisection. The thickness is the rest.
TEST(HolzapfelGasserOgden, StripOfAdventitia) {
  const Adventitia adventitia;
  for (const double s : {1.05, 1.1, 1.15, 1.2}) {
    double low = 0.3, high = 1.2;
    const auto stress = [&](double in_plane) { return adventitia.Stress({s, 1 / (s * in_plane), in_plane}); };
    for (int i = 0; i < 100; ++i) {
      const double middle = 0.5 * (low + high);
      (stress(middle)[2] - stress(middle)[1] < 0 ? low : high) = middle;
    }
    const double expected = stress(low)[0] - stress(low)[1];
    const UniaxialPoint p = UniaxialTension(adventitia.Law(1e11), 0, s);
    ASSERT_TRUE(p.converged) << s;
    EXPECT_NEAR(p.cauchy_stress, expected, 1e-4 * expected) << s;
    EXPECT_NEAR(p.lateral_stretch, low, 1e-5) << s;
    EXPECT_NEAR(p.lateral_stretch_y, 1 / (s * low), 1e-5) << s;
    std::printf("stretch %.2f: %.2f kPa, in plane %.4f, thickness %.4f\n", s, 1e-3 * p.cauchy_stress, p.lateral_stretch,
                p.lateral_stretch_y);
  }
}

// With gamma = 0, no dispersion and half of k1 in each family it is the Fung-type law; with full dispersion it has no
// direction.
TEST(HolzapfelGasserOgden, Limits) {
  const HolzapfelGasserOgden parallel(std::array{6e4, 1e4, 0.5, 0.0, 0.0, 0.0, 0.0, 0.0, 1e6});
  const FungFibre fung(std::array{3e4, 0.0, 2e4, 0.5, 1e6});
  const HolzapfelGasserOgden dispersed(std::array{6e4, 1e4, 0.5, 1.0 / 3, 0.7, 0.0, 0.0, 1.0, 1e6});
  laws::Sampler sampler(9);
  for (int i = 0; i < 100; ++i) {
    const laws::Sample s = sampler.Draw(i, 0);
    const Mat3 P = fung.Stress(s.F, s.fibre);
    const Mat9 tangent = fung.Tangent(s.F, s.fibre);
    EXPECT_LE((parallel.Stress(s.F, s.fibre) - P).norm(), 1e-11 * (P.norm() + 6e4));
    EXPECT_LE((parallel.Tangent(s.F, s.fibre) - tangent).norm(), 1e-11 * tangent.norm());
    const Mat3 isotropic = dispersed.Stress(s.F, s.fibre);
    EXPECT_LE((dispersed.Stress(s.F, {sampler.Direction(), 0}) - isotropic).norm(), 1e-11 * (isotropic.norm() + 6e4));
  }
}

TEST(HolzapfelGasserOgden, KnowsWhereItsFamiliesAre) {
  const HolzapfelGasserOgden law = Adventitia().Law();
  EXPECT_TRUE(law.HasFamiliesAt(Vec3::UnitX()));
  EXPECT_TRUE(law.HasFamiliesAt(Vec3(0.01, 0, 1).normalized()));
  EXPECT_FALSE(law.HasFamiliesAt(Vec3::UnitZ()));
  EXPECT_FALSE(law.HasFamiliesAt(-Vec3::UnitZ()));
  EXPECT_FALSE(
      HolzapfelGasserOgden(std::array{6e4, 1e4, 0.5, 0.0, 0.7, 0.0, 0.0, 0.0, 1e6}).HasFamiliesAt(Vec3::UnitX()));
  EXPECT_TRUE(
      HolzapfelGasserOgden(std::array{6e4, 1e4, 0.5, 0.0, 0.0, 0.0, 0.0, 0.0, 1e6}).HasFamiliesAt(Vec3::UnitX()));
  // Its values stay finite even there: a scene with such fibres is refused.
  const Mat3 F = Vec3(1.2, 0.9, 1.1).asDiagonal();
  EXPECT_TRUE(law.Stress(F, {Vec3::UnitZ(), 0}).allFinite());
}

}  // namespace
}  // namespace fascicle
