// Muscles with a user's or published curves: the published formulas, closed forms, and what is refused.
#include "core/materials/tabulated_muscle.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <vector>

#include "core/materials/gauss_integral.h"
#include "core/materials/muscle.h"
#include "core/materials/uniaxial_curve.h"

namespace fascicle {
namespace {

using ::testing::HasSubstr;

std::shared_ptr<const MuscleCurves> Shared(PublishedCurves set) {
  return std::make_shared<const MuscleCurves>(CurvesOf(set));
}

// The largest difference of a curve from a formula.
template <class Function>
double Difference(const PointCurve& curve, double low, double high, const Function& f) {
  double worst = 0;
  for (int k = 0; k <= 2000; ++k) {
    const double x = low + (high - low) * k / 2000;
    worst = std::max(worst, std::abs(curve.At(x).value - f(x)));
  }
  return worst;
}

TEST(PublishedCurves, Thelen) {
  const MuscleCurves curves = CurvesOf(PublishedCurves::kThelen2003);
  EXPECT_EQ(curves.stress, CurveStress::kForce);
  const double active =
      Difference(curves.active_length, 0.1, 2.4, [](double r) { return std::exp(-(r - 1) * (r - 1) / 0.45); });
  const double passive = Difference(curves.passive_length, 0.5, 1.6, [](double r) {
    return r <= 1 ? 0 : std::expm1(5 * (r - 1) / 0.6) / std::expm1(5);
  });
  // v = (F - 1)/b, b = 1 + 4 F while shortening, 10 (1.4 - F)/0.4 while lengthening.
  double velocity = 0;
  for (double F = 0; F < 1.39; F += 1e-3) {
    const double b = F <= 1 ? 1 + 4 * F : 25 * (1.4 - F);
    velocity = std::max(velocity, std::abs(curves.force_velocity.At((F - 1) / b).value - F));
  }
  std::printf("Thelen 2003: active %.2g, passive %.2g, velocity %.2g\n", active, passive, velocity);
  EXPECT_LT(active, 0.003);
  EXPECT_LT(passive, 0.003);
  EXPECT_LT(velocity, 0.005);
  EXPECT_EQ(curves.force_velocity.At(-1.5).value, 0);
  EXPECT_EQ(curves.force_velocity.At(0.0).value, 1);
  EXPECT_NEAR(curves.passive_length.At(1.6).value, 1, 1e-15);
}

TEST(PublishedCurves, DeGroote) {
  const MuscleCurves curves = CurvesOf(PublishedCurves::kDeGroote2016);
  const double active = Difference(curves.active_length, 0.35, 1.85, [](double r) {
    const auto gaussian = [r](double b1, double b2, double b3, double b4) {
      return b1 * std::exp(-0.5 * std::pow((r - b2) / (b3 + b4 * r), 2));
    };
    return gaussian(0.8150671134243542, 1.055033428970575, 0.162384573599574, 0.063303448465465) +
           gaussian(0.433004984392647, 0.716775413397760, -0.029947116970696, 0.200356847296188) +
           gaussian(0.1, 1, 0.353553390593274, 0);
  });
  const double passive =
      Difference(curves.passive_length, 1, 1.6, [](double r) { return std::expm1(4 * (r - 1) / 0.6) / std::expm1(4); });
  const double velocity = Difference(curves.force_velocity, -1, 1, [](double v) {
    const double z = -8.149 * v - 0.374;
    return -0.3211346127989808 * std::log(z + std::sqrt(z * z + 1)) + 0.8825327733249912;
  });
  std::printf("De Groote 2016: active %.2g, passive %.2g, velocity %.2g\n", active, passive, velocity);
  EXPECT_LT(active, 0.003);
  EXPECT_LT(passive, 0.003);
  EXPECT_LT(velocity, 0.005);
}

// Values from the published formulas, evaluated elsewhere.
TEST(PublishedCurves, Almonacid) {
  const MuscleCurves curves = CurvesOf(PublishedCurves::kAlmonacid2024);
  EXPECT_EQ(curves.stress, CurveStress::kCauchy);
  const std::vector<std::pair<double, double>> active = {
      {0.5, 0.04711639909686218}, {0.6, 0.2420619824110939},  {0.7, 0.594128021636338},   {0.8, 0.8601284399796896},
      {0.9, 0.9668254959269768},  {1.0, 0.9940993884674718},  {1.1, 0.8645808619927554},  {1.2, 0.6661627713175244},
      {1.3, 0.47820665066400925}, {1.4, 0.30151308519975945}, {1.5, 0.15231616291783448}, {1.6, 0.04385764360210546}};
  for (const auto& [r, value] : active) EXPECT_NEAR(curves.active_length.At(r).value, value, 2e-4) << r;
  // The published sum is slightly negative at 0.42, and jumps from 0.003 to 0 at 1.75.
  for (const double r : {0.3, 0.4, 0.42, 1.75, 2.0}) EXPECT_NEAR(curves.active_length.At(r).value, 0, 5e-4) << r;
  EXPECT_EQ(curves.passive_length.At(0.9).value, 0);
  EXPECT_NEAR(curves.passive_length.At(1.1).value, 2.353844827629192 * 0.01, 1e-14);
  EXPECT_NEAR(curves.passive_length.At(1.4).value,
              3.436356700507747 * 0.0225 + 1.176922413814596 * 0.15 + 0.1471153017268245, 1e-13);
  EXPECT_NEAR(curves.passive_length.At(1.85).value, 3.023323249768765 * 0.2 + 1.1, 1e-13);
  EXPECT_NEAR(curves.force_velocity.At(-0.5).value, 0.25792669408341773 * std::pow(0.7, 3) + 0.14317485143460784 * 0.49,
              1e-12);
  EXPECT_NEAR(curves.force_velocity.At(0.02).value,
              -3165.6847983144276 * 8e-6 + 186.19612494819665 * 4e-4 + 6.090887473114851 * 0.02 + 1, 1e-9);
  EXPECT_NEAR(curves.force_velocity.At(2.0).value, 1.5950466421954534, 1e-15);
}

// With the curves of `Muscle` in a table the two laws agree.
TEST(TabulatedMuscle, AgreesWithMuscle) {
  constexpr double kPeak = 3e5, kOptimal = 1.2;
  const Muscle muscle(std::array{500.0, 0.0, 1e7, kPeak, kOptimal, 0.05, 6.6, 1.4});
  CurveTable active, passive;
  for (int i = 0; i <= 32; ++i) {
    active.at.push_back(0.4 + 1.2 * i / 32);
    active.values.push_back(ActiveCurve::Value(active.at.back()));
    passive.at.push_back(1 + 0.4 * i / 32);
    passive.values.push_back(0.05 * std::expm1(6.6 * (passive.at.back() - 1)));
  }
  auto curves = CurvesOf(PublishedCurves::kThelen2003);
  Problems problems;
  curves.active_length = ActiveLengthCurve(active, curves.active_length, problems);
  curves.passive_length = PassiveLengthCurve(passive, curves.passive_length, problems);
  ASSERT_TRUE(problems.empty()) << problems.ToString();
  const TabulatedMuscle law(std::array{500.0, 0.0, 0.0, 1e7, kPeak, kOptimal, 0.0},
                            std::make_shared<const MuscleCurves>(curves));
  for (const double alpha : {0.0, 0.5, 1.0}) {
    // Up to the last point, r = 1.4. The kinks of the active curve at 0.6 and 1.4 are rounded off.
    for (double stretch = 0.5; stretch < 1.4 * kOptimal; stretch += 0.01) {
      EXPECT_NEAR(law.FibreStress(stretch, alpha), muscle.FibreStress(stretch, alpha), 0.004 * kPeak) << stretch;
    }
    const UniaxialPoint a = UniaxialTension(law, alpha, 1.4), b = UniaxialTension(muscle, alpha, 1.4);
    ASSERT_TRUE(a.converged && b.converged);
    EXPECT_NEAR(a.nominal_stress, b.nominal_stress, 0.004 * kPeak);
  }
}

// A fibre of an incompressible bar: sigma = smax m (alpha f_act f_v + f_pass) + the matrix's 2 (l^2 - 1/l) W'(I1).
TEST(TabulatedMuscle, ClosedFormOfABar) {
  constexpr double kC1 = 4e4, kC2 = 7e4, kPeak = 2e5, kOptimal = 1.1, kVelocity = 5;
  const auto curves = Shared(PublishedCurves::kAlmonacid2024);
  for (const CurveStress stress : {CurveStress::kForce, CurveStress::kCauchy}) {
    auto own = std::make_shared<MuscleCurves>(*curves);
    own->stress = stress;
    const TabulatedMuscle law(std::array{kC1, kC2, 0.0, 1e12, kPeak, kOptimal, kVelocity}, own);
    EXPECT_TRUE(law.DependsOnRate());
    for (const double l : {0.7, 1.0, 1.2, 1.5}) {
      for (const double rate : {-3.0, 0.0, 0.2, 2.0}) {
        const double step = 0.01;
        const FibreState fibre{Vec3::UnitZ(), 0.6, l - rate * step, 1 / step};
        const Mat3 F = Vec3(1 / std::sqrt(l), 1 / std::sqrt(l), l).asDiagonal();
        const Mat3 sigma = law.WithVolumeModulus(0).Stress(F, fibre) * F.transpose();
        const double r = l / kOptimal, x = l * l + 2 / l - 3;
        const double pull =
            0.6 * curves->active_length.At(r).value * curves->force_velocity.At(rate / kOptimal / kVelocity).value +
            curves->passive_length.At(r).value;
        const double expected =
            kPeak * (stress == CurveStress::kForce ? r : 1) * pull + 2 * (l * l - 1 / l) * (kC1 + 2 * kC2 * x);
        EXPECT_NEAR(sigma(2, 2) - sigma(0, 0), expected, 1e-9 * kPeak) << l << " " << rate;
      }
    }
  }
}

TEST(MuscleCurves, WorkOfAStep) {
  for (const PublishedCurves set :
       {PublishedCurves::kThelen2003, PublishedCurves::kDeGroote2016, PublishedCurves::kAlmonacid2024}) {
    const MuscleCurves curves = CurvesOf(set);
    for (const double from : {0.35, 0.8, 1.3}) {
      for (const double to : {0.3, 0.79, 1.0, 1.9}) {
        const double rate = 0.9;
        double sum = 0;
        constexpr int kPieces = 20000;
        for (int i = 0; i < kPieces; ++i) {
          const double a = from + (to - from) * i / kPieces, b = from + (to - from) * (i + 1) / kPieces;
          sum += GaussIntegral(a, b, [&](double r) {
            const double f = curves.active_length.At(r).value * curves.force_velocity.At(rate * (r - from)).value;
            return curves.stress == CurveStress::kCauchy ? f / r : f;
          });
        }
        EXPECT_NEAR(curves.ActiveWork(from, to, rate), sum, 1e-10) << from << " " << to;
      }
    }
    EXPECT_FALSE(std::isfinite(curves.ActiveWork(1, std::numeric_limits<double>::quiet_NaN(), 1)));
  }
}

// --- Tables that are refused ---

std::vector<std::string> PathsOf(const Problems& problems) {
  std::vector<std::string> paths;
  for (const Problem& problem : problems.kept()) paths.push_back(problem.path);
  return paths;
}

TEST(CurveTables, ReportEveryProblem) {
  const MuscleCurves own = CurvesOf(PublishedCurves::kThelen2003);
  Problems jump;
  ActiveLengthCurve({{0.4, 1.0, 1.0, 0.9, 1.6}, {0, 1, 0.5, 0.2, -1}}, own.active_length, jump);
  EXPECT_THAT(PathsOf(jump), ::testing::ElementsAre("lengths[2]", "lengths[3]", "values[4]"));
  EXPECT_THAT(jump.kept()[0].message, HasSubstr("jump"));

  Problems close;
  ActiveLengthCurve({{0.4, 1.0, 1.0005}, {0, 1, 0}}, own.active_length, close);
  EXPECT_THAT(PathsOf(close), ::testing::ElementsAre("lengths[2]"));

  Problems passive;
  PassiveLengthCurve({{1, 1.2, 1.4}, {0.1, 0.5, 0.4}}, own.passive_length, passive);
  EXPECT_THAT(PathsOf(passive), ::testing::ElementsAre("values[2]", "values[0]"));

  Problems velocity;
  VelocityCurve({{-1, 0.1, 1}, {0, 1, 1.4}}, own.force_velocity, velocity);
  EXPECT_THAT(PathsOf(velocity), ::testing::ElementsAre("velocities"));
  Problems at_zero;
  VelocityCurve({{-1, 0, 1}, {0, 0.9, 1.4}}, own.force_velocity, at_zero);
  EXPECT_THAT(PathsOf(at_zero), ::testing::ElementsAre("values[1]"));

  Problems count;
  ActiveLengthCurve({{1}, {1, 2}}, own.active_length, count);
  ActiveLengthCurve({std::vector<double>(40, 1.0), std::vector<double>(40, 1.0)}, own.active_length, count);
  EXPECT_GE(count.count(), 3u);
  EXPECT_THAT(count.ToString(), HasSubstr("has 40 points"));
}

}  // namespace
}  // namespace fascicle
