#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <unsupported/Eigen/Splines>
#include <vector>

#include "core/geometry/bspline_fit.h"
#include "core/geometry/bspline_locator.h"
#include "core/geometry/bspline_reader.h"
#include "core/geometry/bspline_solid.h"

namespace fascicle {
namespace {

using ::testing::HasSubstr;

class Random {
 public:
  double Uniform(double low, double high) { return std::uniform_real_distribution(low, high)(engine_); }
  Vec3 In(const Vec3& low, const Vec3& high) {
    return {Uniform(low[0], high[0]), Uniform(low[1], high[1]), Uniform(low[2], high[2])};
  }

 private:
  std::mt19937_64 engine_{20030726};
};

// A block of 1 x 1 x 3 that is twisted by 2 rad, bent and tapered.
Vec3 Bent(const Vec3& p) {
  const double taper = 1 - 0.4 * p.z(), turn = 2 * p.z();
  const Eigen::Vector2d across = Eigen::Rotation2Dd(turn) * (taper * Eigen::Vector2d(p.x() - 0.5, p.y() - 0.5));
  return {across.x() + p.z() * p.z(), across.y(), 3 * p.z() + 0.3 * across.x()};
}

std::vector<SolidSample> SamplesOf(const std::function<Vec3(const Vec3&)>& map, int n) {
  std::vector<SolidSample> samples;
  for (int k = 0; k <= n; ++k) {
    for (int j = 0; j <= n; ++j) {
      for (int i = 0; i <= n; ++i) {
        const Vec3 parameters = Vec3(i, j, k) / n;
        samples.push_back({parameters, map(parameters)});
      }
    }
  }
  return samples;
}

BsplineSolid BentSolid(const std::array<int, 3>& degrees = {3, 3, 3}) {
  return FitBsplineSolid({BsplineBasis::Uniform(degrees[0], 6), BsplineBasis::Uniform(degrees[1], 7),
                          BsplineBasis::Uniform(degrees[2], 9)},
                         SamplesOf(Bent, 12), 1e-12)
      ->solid;
}

// --- Basis -----------------------------------------------------------------------------------------------------------

class BasisOfDegree : public ::testing::TestWithParam<int> {};

// Against Eigen's splines, an independent implementation.
TEST_P(BasisOfDegree, AgreesWithEigen) {
  const int degree = GetParam();
  std::vector<double> knots(static_cast<std::size_t>(degree + 1), -1.0);
  for (const double inner : {-0.3, 0.1, 0.1, 0.9}) {
    if (degree > 1 || knots.back() != inner) knots.push_back(inner);
  }
  knots.insert(knots.end(), static_cast<std::size_t>(degree + 1), 2.0);
  const BsplineBasis basis(degree, knots);
  using Spline = Eigen::Spline<double, 1>;
  const Spline::KnotVectorType eigen_knots =
      Eigen::Map<const Eigen::RowVectorXd>(knots.data(), static_cast<Eigen::Index>(knots.size()));
  Random random;
  for (int n = 0; n < 1000; ++n) {
    const double u = random.Uniform(-1, 2);
    const BsplineBasis::Local local = basis.At(u);
    EXPECT_EQ(local.first, Spline::Span(u, degree, eigen_knots) - degree);
    const auto expected = Spline::BasisFunctionDerivatives(u, 1, degree, eigen_knots);
    for (int i = 0; i <= degree; ++i) {
      EXPECT_NEAR(local.value[static_cast<std::size_t>(i)], expected(0, i), 1e-14);
      EXPECT_NEAR(local.slope[static_cast<std::size_t>(i)], expected(1, i), 1e-12);
    }
  }
}

TEST_P(BasisOfDegree, IsOneAtBothEndsAndSumsToOne) {
  const BsplineBasis basis = BsplineBasis::Uniform(GetParam(), GetParam() + 4);
  const auto degree = static_cast<std::size_t>(GetParam());
  EXPECT_EQ(basis.At(0).value[0], 1);
  EXPECT_EQ(basis.At(1).value[degree], 1);
  EXPECT_EQ(basis.At(1).first + GetParam(), basis.size() - 1);
  EXPECT_EQ(basis.At(7).value, basis.At(1).value);
  for (const double u : {0.0, 0.1, 0.25, 0.5, 0.77, 1.0}) {
    double sum = 0, slope = 0, identity = 0;
    const BsplineBasis::Local local = basis.At(u);
    for (std::size_t i = 0; i <= degree; ++i) {
      sum += local.value[i];
      slope += local.slope[i];
      identity += local.value[i] * basis.Greville(local.first + static_cast<int>(i));
    }
    EXPECT_NEAR(sum, 1, 1e-15);
    EXPECT_NEAR(slope, 0, 1e-12);
    EXPECT_NEAR(identity, u, 1e-15);
  }
}

INSTANTIATE_TEST_SUITE_P(All, BasisOfDegree, ::testing::Range(1, BsplineBasis::kMaxDegree + 1));

TEST(BsplineBasis, SaysWhatIsWrong) {
  const auto size = [](std::int64_t degree, std::int64_t count) {
    Problems problems;
    BsplineBasis::CheckSize(degree, count, problems);
    return problems.ToString();
  };
  EXPECT_THAT(size(0, 5), HasSubstr("degree 0"));
  EXPECT_THAT(size(6, 9), HasSubstr("degree 6"));
  EXPECT_THAT(size((std::int64_t{1} << 32) + 3, 9), HasSubstr("degree 4294967299"));
  EXPECT_THAT(size(3, 3), HasSubstr("at least 4"));
  EXPECT_EQ(size(3, 4), "");
  const auto knots = [](const std::vector<double>& values) {
    Problems problems;
    BsplineBasis::CheckKnots(1, values, problems);
    return problems.ToString();
  };
  EXPECT_THAT(knots({0, 0, NAN, 1, 1}), HasSubstr("finite"));
  EXPECT_THAT(knots({0, 0, 0.6, 0.5, 1, 1}), HasSubstr("descend"));
  EXPECT_THAT(knots({0, 0.1, 0.5, 1, 1}), HasSubstr("not clamped"));
  EXPECT_THAT(knots({0, 0, 0.5, 0.9, 1}), HasSubstr("not clamped"));
  EXPECT_THAT(knots({0, 0, 0.5, 0.5, 1, 1}), HasSubstr("more than 1 interior knots"));
  EXPECT_THAT(knots({0, 0, 0, 1, 1}), HasSubstr("more than 1 interior knots"));
  EXPECT_THAT(knots({0, 0, 0, 0}), HasSubstr("more than 1 interior knots"));
  EXPECT_EQ(knots({0, 0, 0.5, 1, 1}), "");
}

// --- Solid -----------------------------------------------------------------------------------------------------------

TEST(BsplineSolid, HasTheGradientsOfItsValues) {
  const BsplineSolid solid = BentSolid({5, 2, 4});
  Random random;
  constexpr double kStep = 1e-6;
  for (int n = 0; n < 100; ++n) {
    const Vec3 p = random.In(Vec3::Constant(2 * kStep), Vec3::Constant(1 - 2 * kStep));
    const Mat3 gradients = solid.At(p).gradients;
    for (int d = 0; d < 3; ++d) {
      const Vec3 step = kStep * Vec3::Unit(d);
      const Vec3 difference = (solid.At(p + step).position - solid.At(p - step).position) / (2 * kStep);
      EXPECT_LE((gradients.col(d) - difference).norm(), 1e-8);
    }
  }
}

TEST(BsplineSolid, PassesThroughItsCornerControlPoints) {
  const BsplineSolid solid = BentSolid();
  EXPECT_EQ(solid.At(Vec3::Zero()).position, solid.controls().front());
  EXPECT_EQ(solid.At(Vec3::Ones()).position, solid.controls().back());
  EXPECT_EQ(solid.At({1, 0, 0}).position, solid.controls()[5]);
  EXPECT_EQ(solid.At({0, 1, 0}).position, solid.controls()[6 * 6]);
}

// --- Locator ---------------------------------------------------------------------------------------------------------

class LocatorOfDegrees : public ::testing::TestWithParam<std::array<int, 3>> {};

TEST_P(LocatorOfDegrees, FindsTheParametersOfPointsInside) {
  const BsplineLocator locator(BentSolid(GetParam()));
  constexpr std::size_t kPoints = 100'000;
  std::vector<Vec3> parameters, points;
  Random random;
  for (std::size_t n = 0; n < kPoints; ++n) {
    parameters.push_back(random.In(Vec3::Zero(), Vec3::Ones()));
    points.push_back(locator.solid().At(parameters.back()).position);
  }
  ThreadTeam team(2);
  const std::vector<BsplineLocation> found = locator.Locate(points, team);
  ASSERT_EQ(found.size(), kPoints);
  double worst = 0;
  for (std::size_t n = 0; n < kPoints; ++n) {
    ASSERT_TRUE(found[n].inside) << parameters[n].transpose();
    worst = std::max(worst, (found[n].parameters - parameters[n]).cwiseAbs().maxCoeff());
  }
  RecordProperty("worst", ::testing::PrintToString(worst));
  EXPECT_LE(worst, 1e-10);
}

INSTANTIATE_TEST_SUITE_P(All, LocatorOfDegrees,
                         ::testing::Values(std::array{3, 3, 3}, std::array{2, 3, 5}, std::array{4, 5, 2}));

// Trilinear pieces: gradients jump between spans, which Newton's method must cross.
TEST(BsplineLocator, CrossesTheKinksOfDegreeOne) {
  const BsplineLocator locator(BentSolid({1, 1, 1}));
  Random random;
  for (int n = 0; n < 10'000; ++n) {
    const Vec3 p = random.In(Vec3::Zero(), Vec3::Ones());
    const BsplineLocation found = locator.Locate(locator.solid().At(p).position);
    ASSERT_TRUE(found.inside) << p.transpose();
    EXPECT_LE((found.parameters - p).cwiseAbs().maxCoeff(), 1e-10);
  }
}

// A brick with knots in [2, 4], whose nearest point is known: the clamped one.
TEST(BsplineLocator, TakesTheNearestPointForThoseOutside) {
  const std::vector<double> knots = {2, 2, 2, 2.5, 4, 4, 4};
  const BsplineBasis basis(2, knots);
  std::vector<Vec3> controls;
  for (int k = 0; k < 4; ++k) {
    for (int j = 0; j < 4; ++j) {
      for (int i = 0; i < 4; ++i)
        controls.emplace_back(basis.Greville(i), 2 * basis.Greville(j), 5 * basis.Greville(k));
    }
  }
  const BsplineLocator locator(BsplineSolid({basis, basis, basis}, controls));
  Random random;
  int outside = 0;
  for (int n = 0; n < 10'000; ++n) {
    const Vec3 point = random.In({1, 3, 8}, {5, 9, 22});
    const Vec3 nearest = point.cwiseMax(Vec3(2, 4, 10)).cwiseMin(Vec3(4, 8, 20));
    const BsplineLocation found = locator.Locate(point);
    EXPECT_NEAR(found.distance, (point - nearest).norm(), 1e-9);
    EXPECT_LE((found.parameters - nearest.cwiseQuotient(Vec3(1, 2, 5))).norm(), 1e-8);
    EXPECT_EQ(found.inside, point == nearest);
    outside += found.inside ? 0 : 1;
  }
  EXPECT_GT(outside, 5000);
}

// The gradient of the distance vanishes or points out of the box.
TEST(BsplineLocator, EndsAtAMinimumForPointsOutsideOfABentBody) {
  const BsplineLocator locator(BentSolid());
  Random random;
  for (int n = 0; n < 2000; ++n) {
    const Vec3 inside = random.In(Vec3::Zero(), Vec3::Ones());
    const BsplineSolid::Point surface = locator.solid().At({inside.x(), 1, inside.z()});
    const Vec3 outward = surface.gradients.col(2).cross(surface.gradients.col(0)).normalized();
    const Vec3 point = surface.position + 0.05 * outward;
    const BsplineLocation found = locator.Locate(point);
    EXPECT_FALSE(found.inside);
    EXPECT_LE(found.distance, 0.05 + 1e-12);
    const BsplineSolid::Point nearest = locator.solid().At(found.parameters);
    EXPECT_NEAR((point - nearest.position).norm(), found.distance, 1e-14);
    const Vec3 uphill = nearest.gradients.transpose() * (point - nearest.position);
    for (int d = 0; d < 3; ++d) {
      if (found.parameters[d] <= 0) {
        EXPECT_LE(uphill[d], 1e-7);
      } else if (found.parameters[d] >= 1) {
        EXPECT_GE(uphill[d], -1e-7);
      } else {
        EXPECT_NEAR(uphill[d], 0, 1e-7);
      }
    }
  }
}

TEST(BsplineLocator, FindsTheSameBitsWithAnyNumberOfThreads) {
  const BsplineLocator locator(BentSolid());
  Random random;
  std::vector<Vec3> points;
  for (int n = 0; n < 5000; ++n) points.push_back(random.In({-1, -1, -1}, {2, 1, 4}));
  ThreadTeam one(1), four(4);
  const auto first = locator.Locate(points, one), second = locator.Locate(points, four);
  for (std::size_t n = 0; n < points.size(); ++n) {
    ASSERT_EQ(first[n].parameters, second[n].parameters);
    ASSERT_EQ(first[n].distance, second[n].distance);
  }
}

// --- Fit -------------------------------------------------------------------------------------------------------------

// Trilinear maps have zero second differences, so that the fit finds them with any smoothing.
TEST(FitBsplineSolid, IsExactForTrilinearMaps) {
  const auto map = [](const Vec3& p) {
    return Vec3(7 + p.x() + p.y() * p.z(), p.y() - p.x(), 2 * p.z() + p.x() * p.y() * p.z());
  };
  for (const double smoothing : {1e-8, 1.0}) {
    const auto fit =
        FitBsplineSolid({BsplineBasis::Uniform(2, 5), BsplineBasis::Uniform(3, 4), BsplineBasis::Uniform(3, 8)},
                        SamplesOf(map, 9), smoothing);
    ASSERT_TRUE(fit);
    EXPECT_LE(fit->max, 1e-11);
    Random random;
    for (int n = 0; n < 100; ++n) {
      const Vec3 p = random.In(Vec3::Zero(), Vec3::Ones());
      EXPECT_LE((fit->solid.At(p).position - map(p)).norm(), 1e-11);
    }
  }
}

// The error of a least-squares spline of degree p is of order p + 1 in the span.
TEST(FitBsplineSolid, ConvergesWithTheOrderOfItsDegree) {
  const auto error = [](int degree, int spans) {
    const BsplineBasis basis = BsplineBasis::Uniform(degree, spans + degree);
    return FitBsplineSolid({basis, basis, basis}, SamplesOf(Bent, 24), 1e-14)->rms;
  };
  for (const int degree : {1, 2, 3}) {
    const double order = std::log2(error(degree, 3) / error(degree, 6));
    EXPECT_NEAR(order, degree + 1, 0.4) << "degree " << degree;
  }
}

TEST(FitBsplineSolid, SaysHowFarItIsFromTheSamples) {
  const auto samples = SamplesOf(Bent, 8);
  const BsplineBasis basis = BsplineBasis::Uniform(2, 4);
  const auto fit = FitBsplineSolid({basis, basis, basis}, samples, 1e-3);
  ASSERT_TRUE(fit);
  double squares = 0, farthest = 0;
  for (const SolidSample& sample : samples) {
    const double distance = (fit->solid.At(sample.parameters).position - sample.position).norm();
    squares += distance * distance;
    farthest = std::max(farthest, distance);
  }
  EXPECT_GT(fit->rms, 1e-3);
  EXPECT_NEAR(fit->rms, std::sqrt(squares / static_cast<double>(samples.size())), 1e-13);
  EXPECT_NEAR(fit->max, farthest, 1e-13);
}

TEST(FitBsplineSolid, RefusesWhatDeterminesNoSolid) {
  const BsplineBasis basis = BsplineBasis::Uniform(1, 2);
  EXPECT_FALSE(FitBsplineSolid({basis, basis, basis}, {}, 1e-3));
}

// --- File ------------------------------------------------------------------------------------------------------------

constexpr const char* kCube = "degrees 1 1 1\ncontrols 2 2 2\npoints\n0 0 0 1 0 0 0 1 0 1 1 0\n0 0 1 1 0 1 0 1 1 1 1 1";

TEST(ReadBsplineSolid, ReadsACube) {
  Problems problems;
  const auto solid = ReadBsplineSolid("# a cube\nbspline_solid\n" + std::string(kCube), problems);
  ASSERT_TRUE(solid) << problems.ToString();
  EXPECT_EQ(solid->At({0.25, 0.5, 0.75}).position, Vec3(0.25, 0.5, 0.75));
}

TEST(ReadBsplineSolid, ReadsKnots) {
  Problems problems;
  const auto solid = ReadBsplineSolid(
      "bspline_solid degrees 1 1 1 controls 2 2 3 knots w 0 0 3 4 4 points "
      "0 0 0  1 0 0  0 1 0  1 1 0   0 0 1  1 0 1  0 1 1  1 1 1   0 0 2  1 0 2  0 1 2  1 1 2",
      problems);
  ASSERT_TRUE(solid) << problems.ToString();
  EXPECT_EQ(solid->highest(), Vec3(1, 1, 4));
  EXPECT_EQ(solid->At({0, 0, 3}).position, Vec3(0, 0, 1));
  EXPECT_EQ(solid->At({1, 0, 3.5}).position, Vec3(1, 0, 1.5));
}

TEST(ReadBsplineSolid, SaysWhatIsWrongAndWhere) {
  const auto message = [](const std::string& text) {
    Problems problems;
    EXPECT_FALSE(ReadBsplineSolid(text, problems)) << text;
    EXPECT_EQ(problems.count(), 1u) << problems.ToString();
    return problems.ToString();
  };
  const std::string head = "bspline_solid\n";
  EXPECT_THAT(message(""), HasSubstr("file ends where bspline_solid"));
  EXPECT_THAT(message("solid"), HasSubstr("expected bspline_solid but found `solid`"));
  EXPECT_THAT(message(head + "degrees 1 1 x"), HasSubstr("line 2: expected a degree"));
  EXPECT_THAT(message(head + "degrees 1 1 1 controls 2 2 2000000000000 points" + std::string(200, ' ')),
              HasSubstr("2000000000000 control points"));
  EXPECT_THAT(message(head + "degrees 1 1 1 controls 9 9 9 points" + std::string(200, ' ')),
              HasSubstr("control points"));
  EXPECT_THAT(message(head + "degrees 1 1 1 controls -2 2 2 points 1"), HasSubstr("is -2"));
  EXPECT_THAT(message(head + "degrees 7 1 1 controls 2 2 2 points 0 0 0 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1"),
              HasSubstr("u: degree 7"));
  EXPECT_THAT(message(head + "degrees 1 2 1 controls 2 2 2 points 0 0 0 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1"),
              HasSubstr("v: 2 control points are too few"));
  const std::string sizes = head + "degrees 1 1 1\ncontrols 2 2 2\n";
  const std::string points = "points\n0 0 0 1 0 0 0 1 0 1 1 0 0 0 1 1 0 1 0 1 1 1 1 1";
  EXPECT_THAT(message(sizes + "knots t 0 0 1 1\n" + points), HasSubstr("line 4: knots of `t`"));
  EXPECT_THAT(message(sizes + "knots v 0 1 1 1\n" + points), HasSubstr("v: knots are not clamped"));
  EXPECT_THAT(message(sizes + "knots v 0 0 1 nan\n" + points), HasSubstr("v: a knot is not a finite number"));
  EXPECT_THAT(message(sizes + points + " 7"), HasSubstr("more follows than 8 control points"));
  EXPECT_THAT(message(sizes + points.substr(0, points.size() - 1)), HasSubstr("a coordinate"));
  EXPECT_THAT(message(sizes + points.substr(0, points.size() - 1) + "inf"), HasSubstr("not finite"));
}

}  // namespace
}  // namespace fascicle
