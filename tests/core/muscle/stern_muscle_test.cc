#include "core/muscle/stern_muscle.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "core/materials/fibre_curves.h"

namespace fascicle {
namespace {

const SternMuscle kMuscle = {.origin_distance = 0.25,
                             .insertion_distance = 0.04,
                             .peak_force = 800,
                             .optimal_angle = 1.7,
                             .contractile_fraction = 0.6,
                             .hill_curvature = 0.3,
                             .hill_rate = 2};

// The paper's formula, corrected (sign and place of theta-dot), for shortening muscles.
double Published(const SternMuscle& m, double angle, double shortening, double alpha) {
  const double B = m.origin_distance, C = m.insertion_distance, a = m.hill_curvature;
  const double Ki = LengthOf(m, angle) / (B + C), Kl = LengthOf(m, m.optimal_angle) / (B + C);
  const double Y = m.contractile_fraction;
  const double l = (Ki - (1 - Y) * Kl) / (Y * Kl);
  const double P0 = m.peak_force * ActiveCurve::Value(l);
  const double v = (1 / Ki) * (1 / (B / C + 2 + C / B)) * std::sin(angle) * shortening / (m.hill_rate * Y * Kl);
  return P0 * ((1 / a + 1) / (1 + v) - 1) * a * alpha;
}

TEST(SternMuscleTest, LengthIsThatOfTheTriangle) {
  EXPECT_DOUBLE_EQ(LengthOf(kMuscle, 0), 0.21);
  EXPECT_DOUBLE_EQ(LengthOf(kMuscle, std::numbers::pi), 0.29);
  EXPECT_NEAR(LengthOf(kMuscle, std::numbers::pi / 2), std::hypot(0.25, 0.04), 1e-15);
}

TEST(SternMuscleTest, AtRestItPullsIsometrically) {
  EXPECT_DOUBLE_EQ(ForceOf(kMuscle, kMuscle.optimal_angle, 0, 1), 800);
  EXPECT_DOUBLE_EQ(ForceOf(kMuscle, kMuscle.optimal_angle, 0, 0.25), 200);
  EXPECT_LT(ForceOf(kMuscle, 2.5, 0, 1), 800);
  EXPECT_LT(ForceOf(kMuscle, 1, 0, 1), 800);
}

TEST(SternMuscleTest, ShorteningFollowsThePublishedFormula) {
  for (const double angle : {1.2, 1.7, 2.4}) {
    for (const double shortening : {0.0, 1.0, 5.0, 15.0}) {
      const double expected = Published(kMuscle, angle, shortening, 0.7);
      ASSERT_GT(expected, 0);  // 0 beyond the largest rate of shortening
      EXPECT_NEAR(ForceOf(kMuscle, angle, -shortening, 0.7), expected, 1e-12 * kMuscle.peak_force);
    }
  }
  EXPECT_EQ(ForceOf(kMuscle, 1.7, -200, 1), 0);
}

TEST(SternMuscleTest, LengtheningStaysBelowItsPlateau) {
  double last = ForceOf(kMuscle, 1.7, 0, 1);
  for (const double rate : {1.0, 10.0, 100.0, 1e4}) {
    const double force = ForceOf(kMuscle, 1.7, rate, 1);
    EXPECT_GT(force, last);
    EXPECT_LT(force, 1.4 * 800);
    last = force;
  }
  EXPECT_GT(last, 1.38 * 800);
}

const SternDrive kDrive = {{{0.1, 0.3, 0.45}, {2.4, 1.3, 1.6}},
                           {{0, 0.05, 0.4}, {0, 1, 0.5}, Curve::Interpolation::kSmooth}};

TEST(SternMuscleTest, TheForceIsWithinItsTolerance) {
  SternForce force(kMuscle, kDrive, 0.6);
  const auto& [angle, activation] = kDrive;
  for (int k = 0; k < 5000; ++k) {
    const double t = 0.6 * (k + 0.37) / 5000;
    EXPECT_NEAR(force.At(t), ForceOf(kMuscle, angle.At(t), angle.RateAt(t), activation.At(t)), 2e-4 * 800) << t;
  }
  ArchiveWriter archive("force", 1);
  force.Save(archive);
  EXPECT_LT(archive.Finish().size(), 1000 * 2 * sizeof(double));
}

TEST(SternMuscleTest, TheForceHasTheSameBitsAfterALoad) {
  SternForce whole(kMuscle, kDrive, 0.6), first(kMuscle, kDrive, 0.6), second(kMuscle, kDrive, 0.6);
  whole.At(0.6);
  first.At(0.2);
  first.DiscardBefore(0.2);
  ArchiveWriter writer("force", 1);
  first.Save(writer);
  const std::string bytes = writer.Finish();
  ArchiveReader archive(bytes, "force", 1);
  second.Load(archive);
  ASSERT_TRUE(archive.AtEnd());
  for (double t = 0.2; t < 0.6; t += 0.0011) ASSERT_EQ(second.At(t), whole.At(t)) << t;
}

}  // namespace
}  // namespace fascicle
