#ifndef FASCICLE_CORE_BASE_NUMBERS_H_
#define FASCICLE_CORE_BASE_NUMBERS_H_

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

// Functions for formulas that are written once and evaluated for one number or for many side by side (Lanes): here for
// double, in lanes.h for Lanes. A branch is a Select; both of its sides are evaluated.
namespace fascicle {

inline double Select(bool condition, double yes, double no) { return condition ? yes : no; }
inline double Sqrt(double x) { return std::sqrt(x); }
inline double Log(double x) { return std::log(x); }
inline double Exp(double x) { return std::exp(x); }
inline double Expm1(double x) { return std::expm1(x); }

// x^(-1/3) from an approximation y with a relative error of at most 10 %. With r = 1 - x y^3 the result is y (1 -
// r)^(-1/3); the first terms of its series are applied, twice.
template <class T>
T RefinedInverseCubeRoot(const T& x, const T& guess) {
  const T r = 1 - x * guess * guess * guess;
  const T square = r * r;
  const T series = (1.0 / 3.0 + 2.0 / 9.0 * r) + square * ((14.0 / 81.0 + 35.0 / 243.0 * r) + 91.0 / 729.0 * square);
  const T y = guess + guess * (r * series);
  const T left = 1 - x * y * y * y;
  return y + y * (left * (1.0 / 3.0 + 2.0 / 9.0 * left));
}
// x^(-1/3); NaN where x is not positive or is subnormal. Follows the Lanes version step by step, so that both give the
// same bits: exponential curves of the fibre stretch amplify an error of one ulp.
inline double InverseCubeRoot(double x) {
  if (!(x >= std::numeric_limits<double>::min())) return std::nan("");
  constexpr std::uint64_t kOne = 0x3ff0000000000000u, kRootHalf = 0x3fe6a09e667f3bcdu;  // 1 and sqrt(1/2)
  const auto bits = std::bit_cast<std::uint64_t>(x);
  const std::uint64_t exponent = (bits + (kOne - kRootHalf)) >> 52;
  const double f = std::bit_cast<double>(bits - (exponent << 52) + kOne) - 1;
  constexpr double kMagic = 1.5 * 0x1p32;
  const double t = (static_cast<double>(exponent) - 1023 + f * 1.4) * (-1.0 / 3.0) + (kMagic - 0.04);
  const std::uint64_t power = (std::bit_cast<std::uint64_t>(t) - std::bit_cast<std::uint64_t>(kMagic)) << 32;
  return RefinedInverseCubeRoot(x, std::bit_cast<double>(power + kOne));
}

// (exp x - 1)/x, 1 at x = 0. The divided difference of the exponential: (exp a - exp b)/(a - b) = exp b times its value
// at a - b.
template <class T>
T ExponentialQuotient(const T& x) {
  return Select(x == 0, 1, Expm1(x) / x);
}
// (exp x - 1 - x)/x^2, 1/2 at x = 0; near it, where the difference cancels, by its series.
template <class T>
T SecondExponentialQuotient(const T& x) {
  const T square = x * x;
  const T series =
      (0.5 + x / 6) + square * ((1.0 / 24 + x / 120) + square * ((1.0 / 720 + x / 5040) + square * (1.0 / 40320)));
  return Select(square < 2.5e-3, series, (Expm1(x) - x) / square);
}

// f applied to each number by itself, for functions without a branch-free formula.
template <class Function>
double Map(const Function& f, double x) {
  return f(x);
}
template <class Function>
double Map(const Function& f, double x, double y) {
  return f(x, y);
}

}  // namespace fascicle

#endif  // FASCICLE_CORE_BASE_NUMBERS_H_
