#include "core/materials/curve_fit.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numeric>
#include <vector>

namespace fascicle {
namespace {

std::vector<MeasuredPoint> CurveOf(const LawInfo& law, const std::vector<double>& values) {
  std::vector<MeasuredPoint> points;
  for (double s = 0.7; s < 2; s += 0.1) {
    points.push_back({s, UniaxialTension(law.make(values), 0, s).nominal_stress});
  }
  return points;
}

// A law's own curve gives its parameters back, from a start that is off by half.
TEST(CurveFit, FindsTheParametersOfALawsOwnCurve) {
  struct Case {
    const char* law;
    std::vector<double> values, start;
    std::vector<std::size_t> free;
  };
  const std::vector<Case> cases = {{"mooney_rivlin", {3e4, 1e4, 1e8}, {1e5, 0, 1e8}, {0, 1}},
                                   {"yeoh", {3e4, -2e3, 5e2, 1e8}, {1e4, 0, 0, 1e8}, {0, 1, 2}},
                                   {"ogden", {6e4, 3.5, 0, 2, 0, 2, 1e8}, {1e4, 2, 0, 2, 0, 2, 1e8}, {0, 1}},
                                   {"fung_fibre", {1e4, 0, 3e4, 0.8, 1e8}, {5e3, 0, 1e4, 0.3, 1e8}, {0, 2, 3}},
                                   {"holzapfel_gasser_ogden",
                                    {1e4, 3e4, 0.8, 0.1, 0.6, 1, 0, 0, 1e8},
                                    {5e3, 1e4, 0.3, 0.1, 0.6, 1, 0, 0, 1e8},
                                    {0, 1, 2}}};
  for (const Case& c : cases) {
    const LawInfo& law = *FindLaw(c.law);
    const std::vector<MeasuredPoint> points = CurveOf(law, c.values);
    const double before = CompareWithCurve(law, c.start, {}, points).residual;
    const CurveFit fit = FitToCurve(law, c.start, c.free, {}, points);
    EXPECT_TRUE(fit.converged) << c.law;
    EXPECT_LT(fit.residual, 1e-6 * before) << c.law << " after " << fit.iterations;
    for (std::size_t i = 0; i < c.values.size(); ++i) {
      EXPECT_NEAR(fit.values[i], c.values[i], 1e-4 * std::abs(c.values[i])) << c.law << ' ' << i;
    }
  }
}

// Of a curve that the law can't follow, the residual is least: any other value of a parameter gives more.
TEST(CurveFit, LeavesTheLeastResidual) {
  const std::vector<MeasuredPoint> points = CurveOf(*FindLaw("ogden"), {6e4, 5, 0, 2, 0, 2, 1e8});
  const LawInfo& law = *FindLaw("yeoh");
  const std::array<std::size_t, 2> free = {0, 1};
  const CurveFit fit = FitToCurve(law, {1e4, 0, 0, 1e8}, free, {}, points);
  EXPECT_TRUE(fit.converged);
  EXPECT_GT(fit.residual, 1);
  for (const std::size_t i : free) {
    for (const double factor : {0.999, 1.001}) {
      std::vector<double> other = fit.values;
      other[i] *= factor;
      EXPECT_GT(CompareWithCurve(law, other, {}, points).residual, fit.residual);
    }
  }
}

// Rubber that stiffens wants a negative c2 of Mooney-Rivlin, which is out of its range.
TEST(CurveFit, StopsAtTheEndOfARange) {
  const std::vector<MeasuredPoint> points = CurveOf(*FindLaw("yeoh"), {3e4, 5e3, 5e2, 1e8});
  const std::array<std::size_t, 2> free = {0, 1};
  const CurveFit fit = FitToCurve(*FindLaw("mooney_rivlin"), {1e4, 1e4, 1e8}, free, {}, points);
  EXPECT_EQ(fit.values[1], 0);
  EXPECT_GT(fit.values[0], 3e4);
  EXPECT_EQ(fit.values[2], 1e8);
}

}  // namespace
}  // namespace fascicle
