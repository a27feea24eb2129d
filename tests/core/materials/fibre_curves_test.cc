#include "core/materials/fibre_curves.h"
#include "tests/support/paths.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace fascicle {
namespace {

const ExponentialToeCurve kPassive(0.05, 6.6, 1.4);    // [Blemker 2005], relative to the peak stress
const ExponentialToeCurve kTendon(2.7e6, 46.4, 1.03);  // [Blemker 2005], Pa

// Composite Simpson rule.
template <class Function>
double Simpson(const Function& f, double a, double b) {
  constexpr int kIntervals = 2000;
  const double h = (b - a) / kIntervals;
  double sum = f(a) + f(b);
  for (int i = 1; i < kIntervals; ++i) sum += (i % 2 == 1 ? 4 : 2) * f(a + i * h);
  return sum * h / 3;
}

// Integral piece by piece between the kinks, where Simpson's rule is of fourth order.
template <class Function>
double PiecewiseIntegral(const Function& f, std::vector<double> kinks, double a, double b) {
  double sum = 0, from = a;
  kinks.push_back(b);
  for (const double kink : kinks) {
    const double to = std::min(std::max(kink, from), b);
    sum += Simpson(f, from, to);
    from = to;
  }
  return sum;
}

// --- Published values ---

TEST(ActiveCurve, TakesThePublishedValues) {
  for (const auto& [r, value] : {std::pair(0.4, 0.0),
                                 {0.5, 0.09},
                                 {0.6, 0.36},
                                 {0.8, 0.84},
                                 {1.0, 1.0},
                                 {1.2, 0.84},
                                 {1.4, 0.36},
                                 {1.5, 0.09},
                                 {1.6, 0.0},
                                 {0.0, 0.0},
                                 {2.0, 0.0}}) {
    EXPECT_NEAR(ActiveCurve::Value(r), value, 1e-15) << r;
  }
}

// Both curves of Blemker 2005, tabulated from public code (8 digits).
TEST(FibreCurves, AgreeWithTheReferenceTable) {
  const std::filesystem::path data = testing::DataFolder();
  std::ifstream in(data / "reference_curves/muscle_curves.csv");
  if (!in) GTEST_SKIP() << "no reference curves in " << data << "; set FASCICLE_DATA";
  int rows = 0;
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line[0] == '#' || line[0] == 'l') continue;
    std::vector<double> cells;
    std::istringstream row(line);
    for (std::string cell; std::getline(row, cell, ',');) cells.push_back(std::stod(cell));
    ASSERT_EQ(cells.size(), 7u);
    EXPECT_NEAR(ActiveCurve::Value(cells[0]), cells[5], 6e-9) << line;
    EXPECT_NEAR(kPassive.Value(cells[0]), cells[6], 6e-9) << line;
    ++rows;
  }
  EXPECT_EQ(rows, 31);
}

TEST(TendonCurve, TakesThePublishedValues) {
  EXPECT_EQ(kTendon.Value(1), 0);
  EXPECT_EQ(kTendon.Value(0.5), 0);
  EXPECT_NEAR(kTendon.Value(1.02), 2.7e6 * (std::exp(0.928) - 1), 1e-3);
  const double slope = 2.7e6 * 46.4 * std::exp(1.392);
  EXPECT_NEAR(kTendon.Value(1.05), 2.7e6 * (std::exp(1.392) - 1) + 0.02 * slope, 1e-2);
}

// --- Continuity at every kink ---

TEST(ActiveCurve, IsContinuousAtEveryKink) {
  constexpr double kEps = 1e-9;
  for (const double kink : {0.4, 0.6, 1.4, 1.6}) {
    EXPECT_NEAR(ActiveCurve::Value(kink - kEps), ActiveCurve::Value(kink + kEps), 1e-8) << kink;
    EXPECT_NEAR(ActiveCurve::Integral(kink - kEps), ActiveCurve::Integral(kink + kEps), 1e-8) << kink;
  }
  // The slope is continuous at the ends of the active curve, and jumps between the published parabolas.
  for (const double end : {0.4, 1.6}) {
    EXPECT_NEAR(ActiveCurve::Derivative(end - kEps), ActiveCurve::Derivative(end + kEps), 1e-7);
  }
  EXPECT_NEAR(ActiveCurve::Derivative(0.6 - kEps), 3.6, 1e-7);
  EXPECT_NEAR(ActiveCurve::Derivative(0.6 + kEps), 3.2, 1e-7);
  EXPECT_NEAR(ActiveCurve::Derivative(1.4 - kEps), -3.2, 1e-7);
  EXPECT_NEAR(ActiveCurve::Derivative(1.4 + kEps), -3.6, 1e-7);
}

TEST(ExponentialToeCurve, IsContinuousWithOneKinkInItsSlope) {
  constexpr double kEps = 1e-10;
  for (const auto& [curve, transition, initial_slope] :
       {std::tuple(kPassive, 1.4, 0.05 * 6.6), std::tuple(kTendon, 1.03, 2.7e6 * 46.4)}) {
    for (const double kink : {1.0, transition}) {
      const double scale = curve.Derivative(transition);
      EXPECT_NEAR(curve.Value(kink - kEps), curve.Value(kink + kEps), 3 * kEps * scale);
      EXPECT_NEAR(curve.Integral(kink - kEps), curve.Integral(kink + kEps), 3 * kEps * scale);
      EXPECT_NEAR(curve.IntegralOverLength(kink - kEps), curve.IntegralOverLength(kink + kEps), 3 * kEps * scale);
    }
    EXPECT_NEAR(curve.Derivative(transition - kEps) / curve.Derivative(transition + kEps), 1, 1e-7);
    EXPECT_EQ(curve.Derivative(1 - kEps), 0);
    EXPECT_NEAR(curve.Derivative(1 + kEps) / initial_slope, 1, 1e-7);
  }
}

// --- Derivatives and integrals ---

TEST(FibreCurves, DerivativeIsThatOfTheValue) {
  constexpr double kStep = 1e-5;
  for (double r = 0.3037; r < 2; r += 0.01) {
    const auto slope = [&](const auto& value) { return (value(r + kStep) - value(r - kStep)) / (2 * kStep); };
    EXPECT_NEAR(ActiveCurve::Derivative(r), slope([](double x) { return ActiveCurve::Value(x); }), 1e-8) << r;
    EXPECT_NEAR(kPassive.Derivative(r), slope([](double x) { return kPassive.Value(x); }), 1e-8) << r;
  }
}

TEST(FibreCurves, IntegralIsThatOfTheValue) {
  for (double r = 0.31; r < 2; r += 0.053) {
    EXPECT_NEAR(ActiveCurve::Integral(r),
                PiecewiseIntegral([](double x) { return ActiveCurve::Value(x); }, {0.4, 0.6, 1.4, 1.6}, 0, r), 1e-12);
    if (r <= 1) continue;
    EXPECT_NEAR(kPassive.Integral(r), PiecewiseIntegral([](double x) { return kPassive.Value(x); }, {1.4}, 1, r),
                1e-11);
  }
}

TEST(ExponentialToeCurve, IntegralOverLengthAgreesWithQuadrature) {
  for (const double exponent : {1e-3, 0.5, 6.6, 46.4, 300.0}) {
    const double transition = 1 + std::min(0.9, 20 / exponent);
    const ExponentialToeCurve curve(3, exponent, transition);
    for (const double x : {1.0, 1.0001, 1.01, 1.2, 1.9, 2.5}) {
      const double expected = PiecewiseIntegral([&](double s) { return curve.Value(s) / s; }, {transition}, 1, x);
      EXPECT_NEAR(curve.IntegralOverLength(x), expected, 1e-9 * expected) << exponent << ' ' << x;
    }
  }
}

// The closed form with the exponential integral, where it neither cancels nor overflows.
TEST(ExponentialToeCurve, IntegralOverLengthAgreesWithTheExponentialIntegral) {
  for (const double exponent : {0.7, 5.0, 46.4, 200.0}) {
    const ExponentialToeCurve curve(1, exponent, 2);
    for (const double x : {1.3, 1.6, 1.999}) {
      const double expected = std::exp(-exponent) * (std::expint(exponent * x) - std::expint(exponent)) - std::log(x);
      EXPECT_NEAR(curve.IntegralOverLength(x) / expected, 1, 1e-12) << exponent << ' ' << x;
    }
  }
}

}  // namespace
}  // namespace fascicle
