#include "core/base/lanes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "core/base/numbers.h"

namespace fascicle {
namespace {

// Lanes of one width only, because this machine may lack the others. tests/core/tet/kernels_test.cc checks on whole
// force loops that all widths give the same bits.
template <class S>
using L = Lanes<S, BaselineSet>;

template <class S, class Function>
S First(const Function& f, S x) {
  return f(L<S>(static_cast<double>(x)))[L<S>::kLanes - 1];
}

// |value - exact| in units in the last place of the exact value.
template <class S>
double Ulps(S value, long double exact) {
  const S rounded = static_cast<S>(std::abs(exact));
  const long double ulp = std::nextafter(rounded, std::numeric_limits<S>::infinity()) - rounded;
  return static_cast<double>(std::abs(static_cast<long double>(value) - exact) / ulp);
}

template <class S>
class LanesTest : public ::testing::Test {};
using Scalars = ::testing::Types<double, float>;
TYPED_TEST_SUITE(LanesTest, Scalars);

// Over the whole range, and where cancellation would be visible.
TYPED_TEST(LanesTest, LogToTwoUlps) {
  using S = TypeParam;
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> exponent(std::log2(std::numeric_limits<S>::min()) + 1,
                                                  std::log2(std::numeric_limits<S>::max()) - 1);
  std::uniform_real_distribution<double> near(0.5, 2);
  double worst = 0;
  for (int i = 0; i < 200000; ++i) {
    const S x = static_cast<S>(i % 2 == 0 ? std::exp2(exponent(random)) : near(random));
    if (x == 1) continue;
    worst = std::max(worst, Ulps(First<S>([](auto a) { return Log(a); }, x), std::log(static_cast<long double>(x))));
  }
  EXPECT_LT(worst, 2);
  EXPECT_EQ(First<S>([](auto a) { return Log(a); }, S(1)), 0);
}

TYPED_TEST(LanesTest, ExpAndExpm1ToTwoUlps) {
  using S = TypeParam;
  std::mt19937_64 random(2);
  const double range = std::log(std::numeric_limits<S>::max()) - 2;
  std::uniform_real_distribution<double> wide(-range, range), near(-1, 1), tiny(-30, 0);
  double worst_exp = 0, worst_expm1 = 0;
  for (int i = 0; i < 200000; ++i) {
    const double magnitude = std::exp2(tiny(random));
    const S x = static_cast<S>(i % 3 == 0 ? wide(random) : i % 3 == 1 ? near(random) : magnitude);
    const auto exact = static_cast<long double>(x);
    worst_exp = std::max(worst_exp, Ulps(First<S>([](auto a) { return Exp(a); }, x), std::exp(exact)));
    worst_expm1 = std::max(worst_expm1, Ulps(First<S>([](auto a) { return Expm1(a); }, x), std::expm1(exact)));
  }
  EXPECT_LT(worst_exp, 2);
  EXPECT_LT(worst_expm1, 2);
}

TYPED_TEST(LanesTest, InverseCubeRootToTwoUlps) {
  using S = TypeParam;
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> exponent(std::log2(std::numeric_limits<S>::min()) + 1,
                                                  std::log2(std::numeric_limits<S>::max()) - 1);
  std::uniform_real_distribution<double> near(0.5, 2);
  const auto root = [](S x) { return First<S>([](auto a) { return InverseCubeRoot(a); }, x); };
  double worst = 0;
  for (int i = 0; i < 200000; ++i) {
    const S x = static_cast<S>(i % 2 == 0 ? std::exp2(exponent(random)) : near(random));
    worst = std::max(worst, Ulps(root(x), 1 / std::cbrt(static_cast<long double>(x))));
    if constexpr (sizeof(S) == 8) {
      ASSERT_EQ(root(x), InverseCubeRoot(x));
    }
  }
  EXPECT_LT(worst, 2);
  EXPECT_EQ(root(1), 1);
  for (const double x : {0.0, -1.0, std::nan("")}) {
    EXPECT_TRUE(std::isnan(root(static_cast<S>(x))));
    EXPECT_TRUE(std::isnan(InverseCubeRoot(x)));
  }
  EXPECT_NEAR(InverseCubeRoot(8.0), 0.5, 1e-16);
}

TYPED_TEST(LanesTest, EndsOfTheRange) {
  using S = TypeParam;
  const auto log = [](S x) { return First<S>([](auto a) { return Log(a); }, x); };
  const auto exp = [](S x) { return First<S>([](auto a) { return Exp(a); }, x); };
  const S infinity = std::numeric_limits<S>::infinity(), nan = std::numeric_limits<S>::quiet_NaN();
  EXPECT_TRUE(std::isnan(log(-1)));
  EXPECT_TRUE(std::isnan(log(nan)));
  EXPECT_TRUE(std::isnan(exp(nan)));
  EXPECT_EQ(log(0), -infinity);
  EXPECT_EQ(log(infinity), infinity);
  EXPECT_EQ(exp(1e5), infinity);
  EXPECT_EQ(exp(infinity), infinity);
  EXPECT_EQ(exp(-1e5), 0);
  EXPECT_EQ(First<S>([](auto a) { return Expm1(a); }, S(-1e5)), -1);
  const S large = std::log(std::numeric_limits<S>::max()) * S(0.9999);
  EXPECT_NEAR(exp(large) / std::exp(large), 1, 4 * std::numeric_limits<S>::epsilon());
  EXPECT_EQ(First<S>([](auto a) { return Sqrt(a); }, S(2)), std::sqrt(S(2)));
}

TYPED_TEST(LanesTest, SelectTakesEachLaneByItself) {
  using S = TypeParam;
  S values[16];
  for (int k = 0; k < 16; ++k) values[k] = static_cast<S>(k);
  const L<S> x = L<S>::Load(values);
  const L<S> chosen = Select((x < 1) | (x == 1), -x, x * 10);
  for (int k = 0; k < L<S>::kLanes; ++k) EXPECT_EQ(chosen[k], k <= 1 ? -k : 10 * k);
  EXPECT_TRUE((x > 0.5).Any());
  EXPECT_FALSE((x > 100).Any());
  const L<S> mapped = Map([](double a, double b) { return a - b; }, x, L<S>(1));
  for (int k = 0; k < L<S>::kLanes; ++k) EXPECT_EQ(mapped[k], k - 1);
}

// To a few ulps, for one number and for lanes, also across the switch to a series.
TYPED_TEST(LanesTest, ExponentialQuotients) {
  using S = TypeParam;
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> exponent(-25, 3);
  double worst_first = 0, worst_second = 0;
  for (int i = 0; i < 100000; ++i) {
    const S x = static_cast<S>((i % 2 == 0 ? 1 : -1) * std::exp(exponent(random)));
    const long double exact = x;
    const long double first = std::expm1(exact) / exact;
    // The difference cancels for small x, where the first terms of the series are exact.
    const long double second = std::abs(exact) < 1e-3L
                                   ? 0.5L + exact / 6 + exact * exact / 24 + exact * exact * exact / 120
                                   : (std::expm1(exact) - exact) / (exact * exact);
    worst_first = std::max(worst_first, Ulps(First<S>([](auto a) { return ExponentialQuotient(a); }, x), first));
    worst_second =
        std::max(worst_second, Ulps(First<S>([](auto a) { return SecondExponentialQuotient(a); }, x), second));
    if (!std::is_same_v<S, double>) continue;
    worst_first = std::max(worst_first, Ulps<double>(ExponentialQuotient<double>(x), first));
    worst_second = std::max(worst_second, Ulps<double>(SecondExponentialQuotient<double>(x), second));
  }
  EXPECT_LT(worst_first, 3);
  // (exp x - 1 - x) loses a factor of 2/|x| at the end of the series, |x| = 0.05.
  EXPECT_LT(worst_second, 80);
  EXPECT_EQ(ExponentialQuotient(0.0), 1);
  EXPECT_EQ(SecondExponentialQuotient(0.0), 0.5);
}

}  // namespace
}  // namespace fascicle
