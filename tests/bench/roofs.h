#ifndef FASCICLE_TESTS_BENCH_ROOFS_H_
#define FASCICLE_TESTS_BENCH_ROOFS_H_

#include <algorithm>
#include <vector>

#include "core/base/instruction_set.h"
#include "ratio.h"

// The measured peak performance of one core, to compare loops with it: the roofline model [Williams, Waterman &
// Patterson 2009].
namespace fascicle::bench {

typedef double Doubles2 __attribute__((vector_size(16)));
typedef double Doubles4 __attribute__((vector_size(32)));
typedef double Doubles8 __attribute__((vector_size(64)));

// Rounds of 8 additions and 5 multiplications, about the ratio of a voxel's forces. Each depends only on the previous
// round of the same lane. Everything stays in registers.
//   x  one number per lane; they must differ, otherwise compilers merge them
template <class Vector>
[[gnu::always_inline]] inline void AddAndMultiply(long rounds, double (&x)[13]) {
  Vector places[13];
  for (int k = 0; k < 13; ++k) places[k] = Vector{} + x[k];
  const Vector step = Vector{} + 1e-9, factor = Vector{} + (1 - 1e-9);
  for (long round = 0; round < rounds; ++round) {
#pragma GCC unroll 8
    for (int k = 0; k < 8; ++k) {
      places[k] += step;
      if (k < 5) places[8 + k] *= factor;
    }
  }
  for (int k = 0; k < 13; ++k) x[k] = places[k][0];
}
inline void AddAndMultiplyBaseline(long rounds, double (&x)[13]) { AddAndMultiply<Doubles2>(rounds, x); }
#if defined(__x86_64__)
[[gnu::target("avx2")]] inline void AddAndMultiplyAvx2(long rounds, double (&x)[13]) {
  AddAndMultiply<Doubles4>(rounds, x);
}
[[gnu::target("avx512f")]] inline void AddAndMultiplyAvx512(long rounds, double (&x)[13]) {
  AddAndMultiply<Doubles8>(rounds, x);
}
#endif

// Additions of doubles per second, with multiplications among them, with the instruction set of the kernels.
inline double AdditionsPerSecond() {
  constexpr long kSteps = 1'000'000;
  void (*loop)(long, double(&)[13]) = AddAndMultiplyBaseline;
  int lanes = 2;
#if defined(__x86_64__)
  if (PreferredInstructionSet() == InstructionSet::kAvx2) loop = AddAndMultiplyAvx2, lanes = 4;
  if (PreferredInstructionSet() == InstructionSet::kAvx512) loop = AddAndMultiplyAvx512, lanes = 8;
#endif
  double x[13];
  for (int k = 0; k < 13; ++k) x[k] = 1 + 0.1 * k;
  double best = 0;
  for (int run = 0; run < 9; ++run) {
    best = std::max(best, 8.0 * lanes * kSteps / SecondsOf([&] { loop(kSteps, x); }));
  }
  return best;
}

// Bytes per second of a = b + 3 c (24 per number) for vectors far larger than the caches [McCalpin 1995, STREAM triad].
inline double TriadBytesPerSecond() {
  const std::size_t count = std::size_t{1} << 24;
  std::vector<double> a(count), b(count, 1.0), c(count, 2.0);
  double best = 0;
  for (int run = 0; run < 9; ++run) {
    best = std::max(best, 24.0 * static_cast<double>(count) / SecondsOf([&] {
                            for (std::size_t k = 0; k < count; ++k) a[k] = b[k] + 3 * c[k];
                          }));
  }
  return best;
}

}  // namespace fascicle::bench

#endif  // FASCICLE_TESTS_BENCH_ROOFS_H_
